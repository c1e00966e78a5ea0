#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/input_clock.hpp"

namespace modebank {

/// Signals that share their sample times, one sample per column.
struct Stream {
  Eigen::VectorXd time_s;  ///< N, strictly increasing
  Eigen::MatrixXd values;  ///< channels x N
};

/// Linear interpolation at `time_s` (increasing); outside the stream's span the nearest end's value, exactly as
/// numpy.interp. Requires N >= 1.
Eigen::MatrixXd interpolate(const Stream& stream, const Eigen::VectorXd& time_s);

/// The mean over the step that ends at each of `time_s`, `step_s` long, of the stream's linear interpolation, so that
/// samples at the step's ends weigh half. Missing values (NaN) make those means NaN that they lie in. Requires N >= 1.
Eigen::MatrixXd average_ending(const Stream& stream, const Eigen::VectorXd& time_s, double step_s);

/// Which columns are averaged where a log is brought to a lower rate, because they move at each sample of the log; all
/// others are picked: states interpolated, inputs held.
struct AveragedColumns {
  std::vector<Eigen::Index> states = {}, inputs = {};  ///< positions
  /// Added to the lag of averaged inputs, not of held ones: where a lag was found, these are taken in the middle of
  /// each transition (hold_mid_transition).
  double further_lag_s = 0.0;

  bool any() const { return !states.empty() || !inputs.empty(); }
};

/// Whether samples that are `period_s` apart come so fast that columns are averaged at `rate_hz`.
inline bool is_averaged_at(double rate_hz, double period_s) {
  constexpr double faster = 1.5;
  return period_s > 0.0 && rate_hz > 0.0 && rate_hz * period_s * faster <= 1.0;
}

/// Replaces these rows of `values`, one column for each of `time_s`, by average_ending.
void average_rows(const Stream& stream, const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& time_s,
                  double step_s, Eigen::MatrixXd& values);

/// Zero-order hold: the value of the last sample at or before each of `time_s` (increasing); before the first sample,
/// its value. Times that miss a sample by no more than rounding count as equal to it. Requires N >= 1.
Eigen::MatrixXd hold(const Stream& stream, const Eigen::VectorXd& time_s);

/// Weights of interpolated samples: interpolated too, but zero where a sample that was interpolated from has weight
/// zero, because it has a part in the value. `weights` 1 x N.
Eigen::VectorXd interpolate_weights(const Stream& weights, const Eigen::VectorXd& time_s);

/// Samples further apart than this many median periods of their stream have a gap between them.
inline constexpr double gap_periods = 5.0;

/// Standard deviation of the steps about their median, in medians, over all series; gaps are no steps. 0 without any.
double step_scatter(const std::vector<const Eigen::VectorXd*>& times_s);

/// Scatter of the steps beyond which modes are not asked for: the model holds for one step length, so that one motion
/// at steps of many lengths looks like several.
inline constexpr double most_step_scatter = 0.1;

/// Makes values NaN that were interpolated across a gap of the stream they come from (`stream_time_s`, increasing).
void blank_gaps(const Eigen::VectorXd& stream_time_s, const Eigen::VectorXd& time_s, Eigen::MatrixXd& values);

struct JoinTimes {
  double rate_hz = 0.0;  ///< 0: the inputs' own times; else first common time + k / rate_hz
  double lag_s = 0.0;    ///< the input in force at time t is u(t - lag(t)), lag = lag_s + drift (t - reference_s)
  double drift = 0.0;
  double reference_s = 0.0;
};

/// The times that both streams cover once the inputs are delayed: states' first <= t <= last, and inputs' first <=
/// t - lag(t) <= last. May be empty. Requires drift < 1.
Eigen::VectorXd joint_times(const Eigen::VectorXd& states_time_s, const Eigen::VectorXd& inputs_time_s,
                            const JoinTimes& options);

/// The inputs in force in the middle of each transition from time_s(k) to time_s(k + 1) (behind the last: of one more
/// of the median period), once delayed by `clock`. With clock 0 that is the input of time_s(k), if the inputs come at
/// these times; otherwise it is the nearest whole number of samples, where the input at time_s(k) would be the next
/// larger.
Eigen::MatrixXd hold_mid_transition(const Stream& inputs, const Eigen::VectorXd& time_s, const InputClock& clock);

}  // namespace modebank
