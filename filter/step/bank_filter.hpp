#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/kalman.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// A filter's results for one sample. A value is NaN if it does not exist: before the start, and for missing
/// measurements.
struct FilterEstimate {
  Eigen::VectorXd prediction;             ///< n, combined prediction of the state before the measurement
  Eigen::VectorXd innovation;             ///< n_y, measurement minus combined prediction
  Eigen::MatrixXd innovation_covariance;  ///< n_y x n_y, covariance of the combined prediction
  Eigen::VectorXd state;                  ///< n, state after the measurement
  Eigen::MatrixXd covariance;             ///< n x n, covariance of the state after the measurement
  Eigen::VectorXd pit;        ///< n_y, Rosenblatt's transform; if it is an interval, the middle of that interval
  Eigen::VectorXd pit_width;  ///< n_y, width of the interval of pit; 0 for a continuous signal
  Eigen::VectorXd mode_probability_predicted;  ///< K, mode probabilities before the measurement
  Eigen::VectorXd mode_probability;            ///< K, mode probabilities after the measurement
  double nis = 0.0;                            ///< normalised innovation squared of the available signals
  double log_density = 0.0;                    ///< nats
  Eigen::Index steps = 0;  ///< number of model steps from the previous sample; 0 if the filter (re)started here
};

/// Calls visit(part, other part) for the vectors and matrices of an estimate and something with parts of these names.
template <class Estimate, class Other, class Visit>
void each_part(Estimate& estimate, Other& other, Visit visit) {
  visit(estimate.prediction, other.prediction);
  visit(estimate.innovation, other.innovation);
  visit(estimate.innovation_covariance, other.innovation_covariance);
  visit(estimate.state, other.state);
  visit(estimate.covariance, other.covariance);
  visit(estimate.pit, other.pit);
  visit(estimate.mode_probability_predicted, other.mode_probability_predicted);
  visit(estimate.mode_probability, other.mode_probability);
}
/// Copies an estimate to one with the sizes of the measured states alone, which come first.
void take_measured(const FilterEstimate& from, FilterEstimate& to);

/// Prediction of one later sample, combined over all modes.
struct StateForecast {
  Eigen::VectorXd state;             ///< n
  Eigen::MatrixXd covariance;        ///< n x n
  Eigen::VectorXd mode_probability;  ///< K
};

/// Upper limit of normalised squares.
inline constexpr double largest_nis = 1e300;

/// Computes the innovation of a predicted mixture, and its normalised square. Memory is allocated once.
class CombinedInnovation {
 public:
  explicit CombinedInnovation(Eigen::Index n_y) : covariance_(n_y, n_y), residual_(n_y), cholesky_(n_y) {}

  /// Sets innovation and nis from `predicted`, which is C x, and the innovation covariance of the estimate.
  void observe(const Eigen::VectorXd& predicted, const Eigen::Ref<const Eigen::VectorXd>& y, FilterEstimate& estimate) {
    covariance_ = estimate.innovation_covariance;
    residual_ = estimate.innovation = y - predicted;
    Eigen::Index missing = 0;
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (is_missing(y(i))) {
        detach(covariance_, i);
        residual_(i) = 0.0;
        estimate.innovation(i) = not_a_number;
        ++missing;
      }
    cholesky_.factorise(covariance_);
    cholesky_.decorrelate(residual_);
    estimate.nis = cholesky_.squared_distance(residual_);
    if (!(estimate.nis < largest_nis)) estimate.nis = largest_nis;
    if (missing == y.size()) estimate.nis = not_a_number;
  }

 private:
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd residual_;
  small::Ldl<Eigen::Dynamic> cholesky_;
};

/// Filters one stream sample by sample, with a bank of any size and variant: decides whether the filter starts at a
/// sample, makes a step, or waits, and has the equations' results. All estimates, live and in evaluate_run, come from
/// this class. A step does not allocate.
class BankFilter {
 public:
  /// Throws std::invalid_argument for a bank that validate (bank.hpp) rejects, and for FilterVariant::kf with several
  /// modes.
  BankFilter(const Bank& bank, const FilterOptions& options);
  ~BankFilter();
  BankFilter(BankFilter&&) noexcept;
  BankFilter& operator=(BankFilter&&) noexcept;

  /// As filter::BankFilter::step. Throws std::invalid_argument for other sizes than m and n_y.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// The result of the last step.
  const FilterEstimate& estimate() const { return estimate_; }
  void restart();
  bool started() const { return started_; }

  /// As filter::BankFilter::forecast.
  std::vector<StateForecast> forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs, Eigen::Index steps) const;

  /// The complete state between two samples, as numbers that a program can store.
  std::vector<double> snapshot() const;
  /// As filter::BankFilter::restore.
  void restore(std::span<const double> snapshot);

 private:
  struct Equations;
  SampleFeed feed_;
  Eigen::Index earliest_input_;
  Eigen::MatrixXd C_;
  Eigen::VectorXd initial_probability_;
  std::unique_ptr<Equations> equations_;
  FilterEstimate estimate_;
  Eigen::VectorXd predicted_;  ///< n_y, C x
  CombinedInnovation innovation_;
  bool started_ = false;

  template <class Filter>
  void take(Filter& filter, const Eigen::Ref<const Eigen::VectorXd>& measurement);
  void wait();
  void clear_prediction();
  void clear_scores();
};

/// Log predictive density of every sample of a run [nats], N; NaN where there is none. Rounded signals have the
/// densities of the filter, whose R has the rounding, and not the masses of BankFilter's estimates. Stores nothing
/// else. Throws the exceptions of check_run; checks no number of the bank, because candidates of an optimiser may be
/// extreme.
Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// Seed for the draws of one run.
std::uint64_t pit_seed(std::uint64_t seed, std::string_view run);

/// Draws the transform of a quantised measurement within its interval (ImmFilter::transform). Moves `pit` (n_y) from
/// the middle of an interval of `width` (n_y) to a uniformly drawn point of the interval. If the model is correct, the
/// transform is then uniform. The draw depends only on `of_run` (pit_seed) and the sample's number. Continuous signals
/// (width 0) do not change.
void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit);

/// Verdict about a live sample, in addition to its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the moments of the mixture
  bool alarm = false;            ///< whether some signal lies in one of the two tails of probability 0.0005
};

/// Judges a sample by the filter's own uncertainty. The alarm uses the probability transform, which has the same
/// distribution for every mixture; the NIS does not. A correct model with one signal has one alarm in 1000 samples.
/// `C`: the bank's. Does not allocate after the first call.
void judge_live(const Eigen::MatrixXd& C, const FilterEstimate& estimate, LiveVerdict& verdict);

}  // namespace modebank
