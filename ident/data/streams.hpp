#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Signals with common sample times, one sample per column.
struct Stream {
  Eigen::VectorXd time_s;  ///< N sample times, strictly increasing
  Eigen::MatrixXd values;  ///< channels x N
};

/// Linear interpolation at `time_s` (increasing). Outside the stream's span it returns the value at the nearest end, as
/// numpy.interp does. Requires N >= 1.
Eigen::MatrixXd interpolate(const Stream& stream, const Eigen::VectorXd& time_s);

/// Mean of the stream's linear interpolation over a step, for each of `time_s`. The step has length `step_s` and ends
/// at that time. Samples at the ends of the step have half weight. A missing value (NaN) makes every mean that contains
/// it NaN. Requires N >= 1.
Eigen::MatrixXd average_ending(const Stream& stream, const Eigen::VectorXd& time_s, double step_s);

/// Columns that are averaged when a log is reduced to a lower rate, because their values change at each sample of the
/// log. Columns of states that are not averaged are interpolated, and columns of inputs are held.
struct AveragedColumns {
  std::vector<Eigen::Index> states = {}, inputs = {};  ///< positions

  /// Lag that is added for averaged inputs. The lag of held inputs does not change. If a lag is estimated, averaged
  /// inputs are taken at the middle of each transition (hold_mid_transition).
  double further_lag_s = 0.0;

  bool any() const { return !states.empty() || !inputs.empty(); }
};

/// Whether samples with the period `period_s` are fast enough for averages at `rate_hz`.
inline bool is_averaged_at(double rate_hz, double period_s) {
  constexpr double faster = 1.5;
  return period_s > 0.0 && rate_hz > 0.0 && rate_hz * period_s * faster <= 1.0;
}

/// Replaces the given rows of `values` by the result of average_ending. `values` has one column for each of `time_s`.
void average_rows(const Stream& stream, const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& time_s,
                  double step_s, Eigen::MatrixXd& values);

/// Zero-order hold: the value of the last sample at or before each of `time_s` (increasing). Before the first sample,
/// the first value is used. A sample that is later than a time only by rounding is also used. Requires N >= 1.
Eigen::MatrixXd hold(const Stream& stream, const Eigen::VectorXd& time_s);

/// A gap lies between two samples if their distance is above this number of median periods of the stream.
inline constexpr double gap_periods = 5.0;

/// Standard deviation of the steps about their median, divided by the median, over all series. Gaps do not count as
/// steps. 0 without steps.
double step_scatter(const std::vector<const Eigen::VectorXd*>& times_s);

/// Modes are searched only if the scatter of the steps is at most this value. A model holds for one step length. With
/// mixed step lengths, a single motion looks like several motions.
inline constexpr double most_step_scatter = 0.1;

/// Replaces by NaN all values that were interpolated across a gap of the stream with the times `stream_time_s`
/// (increasing).
void blank_gaps(const Eigen::VectorXd& stream_time_s, const Eigen::VectorXd& time_s, Eigen::MatrixXd& values);

struct JoinTimes {
  double rate_hz = 0.0;  ///< 0 keeps the inputs' own times; otherwise the times are the first common time + k / rate_hz
  double lag_s = 0.0;    ///< the input that acts at time t is u(t - lag_s); negative: the stamps are late
};

/// The times that both streams cover after the inputs are delayed. They satisfy first <= t <= last of the states, and
/// first <= t - lag_s <= last of the inputs. May be empty.
Eigen::VectorXd joint_times(const Eigen::VectorXd& states_time_s, const Eigen::VectorXd& inputs_time_s,
                            const JoinTimes& options);

/// The inputs, delayed by `lag_s`, that act in the middle of each transition from time_s(k) to time_s(k + 1). For the
/// last column a further transition of the median period is assumed. If the inputs have these times and `lag_s` is 0,
/// the result is the input of time_s(k). Otherwise the delay is rounded to the nearest whole number of samples. (Inputs
/// held at time_s(k) would have a delay that is rounded up.)
Eigen::MatrixXd hold_mid_transition(const Stream& inputs, const Eigen::VectorXd& time_s, double lag_s);

}  // namespace modebank
