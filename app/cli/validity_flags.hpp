#pragma once

#include <Eigen/Core>
#include <utility>

#include "filter/step/bank_filter.hpp"
#include "io/archive/load_input_range.hpp"

namespace modebank::app {

/// Reasons not to rely on a line of `track`.
struct ValidityFlags {
  bool warming_up = false;             ///< the filter has not started, or has predicted fewer than ten samples since
  bool input_beyond_training = false;  ///< an input is outside the range that it has in the training runs
  bool unlike_any_mode = false;        ///< no mode predicts the measurement
  bool stamp_late = false;             ///< one and a half model steps or more after the sample before
};

/// Sets the flags of a stream of samples. Holds what SampleFeed counts, so that a filter that goes on from a checkpoint
/// has the same flags.
class ValidityJudge {
 public:
  /// `lags`: samples that the filter needs to start; `dt_s`: of a model step.
  ValidityJudge(InputRange trained, Eigen::Index lags, double dt_s)
      : trained_(std::move(trained)), lags_(lags), dt_s_(dt_s) {}

  /// The filter starts anew.
  void restart() { samples_ = 0; }
  /// The filter goes on after so many samples, the last at this time.
  void go_on(Eigen::Index samples, double time_s) {
    samples_ = samples;
    last_s_ = time_s;
  }
  /// Takes the next sample. `started`: whether the filter has had a start by now.
  ValidityFlags judge(double time_s, const Eigen::VectorXd& input, const FilterEstimate& estimate, bool started);

 private:
  InputRange trained_;
  Eigen::Index lags_;
  double dt_s_;
  Eigen::Index samples_ = 0;  ///< since the filter forgot all
  double last_s_ = 0.0;

  bool is_beyond_training(const Eigen::VectorXd& input) const;
};

}  // namespace modebank::app
