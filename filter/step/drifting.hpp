#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/drifting_recursion.hpp"
#include "modebank/base/names.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// How well the chosen settings do on the training runs, and whether the grid was wide enough.
struct DriftingTuning {
  double log_score = 0.0;    ///< of the training runs [nats/sample]
  Eigen::Index samples = 0;  ///< scored there
  /// Settings whose best value is the grid's last while it could go on: of "q", "p0", "leak", "lam", "nu", "floor",
  /// "horizon_factor".
  std::vector<std::string> at_grid_end;
};

/// Coefficients of an ARX model that wander. all: every coefficient by itself. constant: the constant. gain: one factor
/// on all coefficients of inputs, each keeping its share. The others of the last two are learned in a run, from p0 on.
enum class Wandering { all, constant, gain };

template <>
struct EnumNames<Wandering> {
  static constexpr Names<3> values{"all", "constant", "gain"};
};

/// One ARX model whose coefficients wander, the competitor `drifting` (method: section 6). With h the regressors
/// [z; v; (1)] of LinearStructure, each over its `scale`,
///   x[k+1] = x[k] + theta[k]' h[k] + e[k],  theta[k] = theta0 + leak (theta[k-1] - theta0) + w[k],  cov(w) = q v W,
/// W = I, or d d' of the direction that wanders, e Student t of variance v, and v a running variance of each output by
/// itself:
///   v <- max(lam v + (1 - lam) e^2 / (1 + h'Ph), floor), from v0 at a start.
/// theta0 is in increment form and of the regressors as they are, as everywhere: the coefficient of x[k] in x[k+1] is 1
/// more. The increment wanders as x[k+1] itself would, because x[k] is known. Given the past, outputs are independent.
struct DriftingModel {
  LinearStructure structure;
  std::vector<std::string> state_names;  ///< as a bank's of this structure
  std::vector<std::string> input_names;
  double dt_s = 0.0;       ///< median sample period of the training data
  Eigen::VectorXd theta0;  ///< p, least squares of the training runs
  Eigen::VectorXd scale;   ///< r, root mean square of each regressor there; 1 where that is zero
  DriftRates rates;        ///< q, p0, leak
  Wandering wandering = Wandering::all;
  double lam = 0.9;                ///< forgetting of the running variance, in (0, 1)
  double nu = 0.0;                 ///< degrees of freedom, above 2; 0: Gaussian
  Eigen::VectorXd v0;              ///< n, variance of the training residuals: v at a start
  Eigen::VectorXd variance_floor;  ///< n, least v
  Eigen::VectorXd quantum = {};    ///< n, as a bank's: intervals are what it is scored by, values what it learns from
  /// What the first-order variance so many samples ahead is multiplied with: ascending horizons from 2 on. One sample
  /// ahead it is 1, so that it is the filter's own prediction.
  std::vector<std::pair<Eigen::Index, double>> horizon_factor;
  DriftingTuning tuning;

  /// Of the longest horizon that is not longer than this one; 1 without.
  double factor_at(Eigen::Index horizon) const;
  /// r x n, as DriftingRecursion takes it.
  Eigen::MatrixXd direction() const;
};

/// Throws std::invalid_argument naming the first thing that no filter can work with.
void validate(const DriftingModel& model);

/// The bank of one mode that it is while nothing drifts: theta0, Q = diag(v0), R = 0. Whoever takes samples for banks
/// (check_run, RunSamples, SampleFeed) takes them for it: scored samples are that bank's.
Bank fixed_bank(const DriftingModel& model);

/// The running variance of every output after a sample; what is missing of it changes nothing.
void adapt_variance(const DriftingModel& model, const DriftingRecursion& recursion, Eigen::VectorXd& v);

/// All that a DriftingFilter remembers.
struct DriftingSnapshot {
  DriftingMemory coefficients;
  Eigen::VectorXd v;
  bool started = false;
  SampleFeed::Memory samples;
};

/// The model at work, sample by sample, as BankFilter: same starts, same samples, same treatment of what is missing and
/// of gaps. Its estimate is that of one mode: state is z with the newest measured value (the prediction where missing),
/// covariance zero, innovation_covariance diagonal, pit by Student's distribution, log_density the outputs' sum; of
/// quantised outputs log (mass of the interval / q). A step allocates nothing.
class DriftingFilter {
 public:
  /// Throws std::invalid_argument for a model that validate refuses.
  DriftingFilter(const DriftingModel& model);
  ~DriftingFilter();
  DriftingFilter(DriftingFilter&&) noexcept;
  DriftingFilter& operator=(DriftingFilter&&) noexcept;

  /// As BankFilter::step.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  const FilterEstimate& estimate() const;
  void restart();
  bool started() const;

  DriftingSnapshot snapshot() const;
  /// Throws std::invalid_argument when the snapshot is not of such a model; the filter is then as it was.
  void restore(const DriftingSnapshot& snapshot);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace modebank
