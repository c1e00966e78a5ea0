#pragma once

#include <Eigen/Core>
#include <memory>

#include "filter/step/bank.hpp"
#include "filter/step/equations/drift_state.hpp"
#include "filter/step/feed/sample_feed.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// What a filter says about one sample. Before it has started, and where a measurement is missing, the numbers that
/// there are none of are NaN.
struct FilterEstimate {
  Eigen::VectorXd prediction;                  ///< n, combined prediction of the state before the measurement
  Eigen::VectorXd innovation;                  ///< n_y, measurement minus combined prediction
  Eigen::MatrixXd innovation_covariance;       ///< n_y x n_y, of the combined prediction
  Eigen::VectorXd state;                       ///< n, after the measurement
  Eigen::MatrixXd covariance;                  ///< n x n, after the measurement
  Eigen::VectorXd pit;                         ///< n_y, Rosenblatt's transform; of an interval its middle
  Eigen::VectorXd pit_width;                   ///< n_y, from its lower to its upper end; 0 of a continuous signal
  Eigen::VectorXd mode_probability_predicted;  ///< K, before the measurement
  Eigen::VectorXd mode_probability;            ///< K, after the measurement
  double nis = 0.0;                            ///< of the signals that are there
  double log_density = 0.0;                    ///< nats
  double spread_share = 0.0;                   ///< of the modes' differences in the trace of innovation_covariance
  Eigen::Index steps = 0;                      ///< model steps from the sample before; 0: the filter (re)started here
};

/// What a filter knows between two samples, of any bank and variant.
struct FilterMemory {
  Eigen::MatrixXd means;             ///< n x K
  Eigen::MatrixXd covariances;       ///< n*n x K
  Eigen::VectorXd mode_probability;  ///< K
  double noise_scale = 1.0;
  double noise_samples = 0.0;  ///< how many samples the scale rests on
  DriftState drift = {};       ///< of modes that drift; empty otherwise
};

/// All that a BankFilter remembers, to go on later where it stopped.
struct FilterSnapshot : FilterMemory {
  bool started = false;
  SampleFeed::Memory samples;
};

/// A bank at work, sample by sample, whatever its sizes and the variant: the one way from samples to estimates, live
/// and in evaluate_run. A step allocates nothing.
class BankFilter {
 public:
  /// Throws std::invalid_argument for a bank that validate (bank.hpp) refuses, and for FilterVariant::kf of several
  /// modes.
  BankFilter(const Bank& bank, const FilterOptions& options);
  ~BankFilter();
  BankFilter(BankFilter&&) noexcept;
  BankFilter& operator=(BankFilter&&) noexcept;

  /// The next sample in the order of time: its time (NaN: one step after the last), the input recorded at it (m; what
  /// is not finite is the last known one, at first zero) and the measurement (n_y; NaN where missing). The first whole
  /// measurement is the start. Throws std::invalid_argument for other sizes.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// What the last step said.
  const FilterEstimate& estimate() const;
  /// Forgets everything; the next whole measurement is a start.
  void restart();
  bool started() const;

  FilterSnapshot snapshot() const;
  /// Throws std::invalid_argument when the snapshot is of a bank of other sizes, or holds numbers that no filter has;
  /// the filter is then as it was.
  void restore(const FilterSnapshot& snapshot);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace modebank
