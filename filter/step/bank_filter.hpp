#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/step/bank.hpp"
#include "filter/step/drift_rates.hpp"
#include "filter/step/feed/sample_feed.hpp"
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

/// State of a filter between two samples, for any bank and variant.
struct FilterMemory {
  Eigen::MatrixXd means;             ///< n x K
  Eigen::MatrixXd covariances;       ///< n*n x K
  Eigen::VectorXd mode_probability;  ///< K
  DriftState drift = {};             ///< of a mode that drifts (DriftingRecursion); empty otherwise
};

/// The complete state of a BankFilter, for continuing later.
struct FilterSnapshot : FilterMemory {
  bool started = false;
  SampleFeed::Memory samples;
};

/// Filters one stream sample by sample, with a bank of any size and variant. All estimates, live and in evaluate_run,
/// come from this class. A step does not allocate.
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
  const FilterEstimate& estimate() const;
  /// Resets the filter; the next complete measurement starts it again.
  void restart();
  bool started() const;

  FilterSnapshot snapshot() const;
  /// Throws std::invalid_argument if the sizes of the snapshot's bank differ, or if it has invalid numbers. The filter
  /// is then unchanged.
  void restore(const FilterSnapshot& snapshot);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace modebank
