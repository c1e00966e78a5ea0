#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
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

  /// Processes the next sample in time order. time: NaN means one step after the last sample. input (m): recorded at
  /// that time. A non-finite input is replaced by its last known value, which is zero at first. measurement (n_y): NaN
  /// where missing. The first complete measurement starts the filter. Throws std::invalid_argument for other sizes.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// The result of the last step.
  const FilterEstimate& estimate() const { return estimate_; }
  /// Resets the filter; the next complete measurement starts it again.
  void restart();
  bool started() const { return started_; }

  /// Predicts the next `steps` samples, one model step apart. Column i of `inputs` (m x c) is the input recorded at the
  /// sample i + 1 ahead. Inputs act input_delay samples later, so as many of the last columns as the earliest input is
  /// late have no effect and may be omitted. Before the filter's start, states are NaN. Throws std::invalid_argument
  /// for too few inputs, for inputs that are not finite, and for steps below 1.
  std::vector<StateForecast> forecast(const Eigen::Ref<const Eigen::MatrixXd>& inputs, Eigen::Index steps) const;

  /// The complete state between two samples, as numbers that a program can store.
  std::vector<double> snapshot() const;
  /// Continues from a snapshot, to the bit. Throws std::invalid_argument if the sizes of the snapshot's bank differ, or
  /// if it has invalid numbers. The filter is then unchanged.
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

}  // namespace modebank
