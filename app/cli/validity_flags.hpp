#pragma once

#include <Eigen/Core>
#include <utility>

#include "filter/step/bank_filter.hpp"
#include "io/archive/load_input_range.hpp"

namespace modebank::app {

/// Reasons not to trust an output line of `track`.
struct ValidityFlags {
  bool warming_up = false;  ///< the filter has not started, or has made fewer than ten predictions since the start
  bool input_beyond_training = false;  ///< an input is outside the range of the training runs
  bool unlike_any_mode = false;        ///< no mode predicts the measurement well
  bool stamp_late = false;             ///< at least one and a half model steps passed since the sample before
};

/// Sets the flags for a stream of samples.
class ValidityJudge {
 public:
  /// `lags`: samples before the filter starts; `dt_s`: period of a model step.
  ValidityJudge(InputRange trained, Eigen::Index lags, double dt_s)
      : trained_(std::move(trained)), lags_(lags), dt_s_(dt_s) {}

  /// Call this when the filter starts anew.
  void restart() { samples_ = 0; }
  /// Judges the next sample. `started`: whether the filter has started.
  ValidityFlags judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate, bool started);

 private:
  InputRange trained_;
  Eigen::Index lags_;
  double dt_s_;
  Eigen::Index samples_ = 0;  ///< number of samples since the filter's restart
  double last_s_ = 0.0;

  bool is_beyond_training(const Eigen::VectorXd& input) const;
};

}  // namespace modebank::app
