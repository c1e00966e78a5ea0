#pragma once

#include <Eigen/Core>
#include <utility>

#include "filter/step/bank_filter.hpp"
#include "io/archive/load_input_range.hpp"

namespace modebank::app {

/// Reasons not to rely on a line of `track`.
struct ValidityFlags {
  bool warming_up = false;             ///< the filter has not started, or has predicted fewer than ten samples since
  bool input_beyond_training = false;  ///< an input is outside of its range in the training runs
  bool unlike_any_mode = false;        ///< no mode predicts the measurement
  bool stamp_late = false;             ///< the sample comes at least one and a half model steps after the one before
};

/// Sets the flags of a stream of samples. Its state follows from SampleFeed, so that a filter continued from a
/// checkpoint has the same flags.
class ValidityJudge {
 public:
  /// `lags`: samples that the filter needs to start; `dt_s`: period of a model step.
  ValidityJudge(InputRange trained, Eigen::Index lags, double dt_s)
      : trained_(std::move(trained)), lags_(lags), dt_s_(dt_s) {}

  /// Call it when the filter starts anew.
  void restart() { samples_ = 0; }
  /// Continues after this number of samples, the last at this time.
  void go_on(Eigen::Index samples, double time_s) {
    samples_ = samples;
    last_s_ = time_s;
  }
  /// Judges the next sample. `started`: whether the filter has started.
  ValidityFlags judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate, bool started);

 private:
  InputRange trained_;
  Eigen::Index lags_;
  double dt_s_;
  Eigen::Index samples_ = 0;  ///< since the filter's restart
  double last_s_ = 0.0;

  bool is_beyond_training(const Eigen::VectorXd& input) const;
};

}  // namespace modebank::app
