#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "filter/step/bank.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/samples.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/bank_filter.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// filter::Estimate with matrices of Eigen.
struct FilterEstimate {
  Eigen::VectorXd prediction, state;      ///< n
  Eigen::MatrixXd covariance;             ///< n x n
  Eigen::VectorXd innovation;             ///< n_y
  Eigen::MatrixXd innovation_covariance;  ///< n_y x n_y
  Eigen::VectorXd pit, pit_width;         ///< n_y; for a rounded signal middle and width of an interval
  Eigen::VectorXd mode_probability_predicted, mode_probability;  ///< K
  double nis = 0.0, log_density = 0.0;
  Eigen::Index steps = 0;
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

/// Computes the innovation of a predicted mixture, and its normalised square. Memory is allocated once.
class CombinedInnovation {
 public:
  explicit CombinedInnovation(Eigen::Index n_y) : covariance_(n_y, n_y), residual_(n_y), cholesky_(n_y) {}

  /// Sets innovation and nis from `predicted`, which is C x, and the innovation covariance of the estimate.
  void observe(const Eigen::VectorXd& predicted, const Eigen::Ref<const Eigen::VectorXd>& y, FilterEstimate& estimate);

 private:
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd residual_;
  small::Ldl<Eigen::Dynamic> cholesky_;
};

/// filter::BankFilter with vectors of Eigen: starts at a sample, makes a step, or waits. All estimates, live and in
/// evaluate_run, come from this class. A step does not allocate.
class BankFilter {
 public:
  /// Throws std::invalid_argument for a bank that validate (bank.hpp) rejects, and for FilterVariant::kf with several
  /// modes.
  BankFilter(const Bank& bank, const FilterOptions& options);
  ~BankFilter();
  BankFilter(BankFilter&&) noexcept;
  BankFilter& operator=(BankFilter&&) noexcept;

  /// Requires m inputs and n_y measurements.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  const FilterEstimate& estimate() const { return estimate_; }
  void restart();
  bool started() const { return started_; }
  std::vector<filter::Forecast> forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs, Eigen::Index steps) const;
  std::vector<double> snapshot() const;
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

/// Log predictive density of every sample of a run [nats]; NaN where there is none. Rounded signals have the densities
/// of the filter, not the masses of BankFilter's estimates. Throws the exceptions of check_run; checks no number of the
/// bank, because candidates of an optimiser may be extreme.
Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options);

/// Seed for the draws of one run.
std::uint64_t pit_seed(std::uint64_t seed, std::string_view run);

/// Moves the transforms `pit` (n_y) of quantised measurements from the middle of an interval of `width` (n_y) to a
/// uniformly drawn point of it, by `of_run` (pit_seed) and the sample's number alone.
void draw_pit(std::uint64_t of_run, Eigen::Index sample, const Eigen::Ref<const Eigen::VectorXd>& width,
              Eigen::Ref<Eigen::VectorXd> pit);

/// Verdict about a live sample, in addition to its estimate.
struct LiveVerdict {
  Eigen::VectorXd predicted;     ///< n_y, predicted measurement
  Eigen::VectorXd lower, upper;  ///< n_y, predicted interval: +- quantile * sqrt(S_ii), by the moments of the mixture
  bool alarm = false;            ///< whether some signal lies in one of the two tails of probability 0.0005
};

/// Judges a sample by the probability transform, which has the same distribution for every mixture; the NIS does not. A
/// correct model with one signal has one alarm in 1000 samples. Does not allocate after the first call.
void judge_live(const Eigen::MatrixXd& C, const FilterEstimate& estimate, LiveVerdict& verdict);

}  // namespace modebank
