#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/data/input_clock.hpp"

namespace modebank {

/// Signals with common sample times, one sample per column.
struct Stream {
  Eigen::VectorXd time_s;  ///< N, strictly increasing
  Eigen::MatrixXd values;  ///< channels x N
};

/// Linear interpolation at `time_s` (increasing). Outside the stream's span it returns the value of the nearest end, as
/// numpy.interp does. Requires N >= 1.
Eigen::MatrixXd interpolate(const Stream& stream, const Eigen::VectorXd& time_s);

/// Mean of the stream's linear interpolation over the step of length `step_s` that ends at each of `time_s`. Samples at
/// the step's ends have half weight. A missing value (NaN) makes every mean that contains it NaN. Requires N >= 1.
Eigen::MatrixXd average_ending(const Stream& stream, const Eigen::VectorXd& time_s, double step_s);

/// Columns that are averaged when a log is reduced to a lower rate, because they change at each sample of the log. In
/// all others single samples are taken: states interpolated, inputs held.
struct AveragedColumns {
  std::vector<Eigen::Index> states = {}, inputs = {};  ///< positions
  /// Added to the lag of averaged inputs, not of held ones. With an estimated lag, averaged inputs are taken in the
  /// middle of each transition (hold_mid_transition).
  double further_lag_s = 0.0;

  bool any() const { return !states.empty() || !inputs.empty(); }
};

/// Whether samples `period_s` apart are fast enough for columns to be averaged at `rate_hz`.
inline bool is_averaged_at(double rate_hz, double period_s) {
  constexpr double faster = 1.5;
  return period_s > 0.0 && rate_hz > 0.0 && rate_hz * period_s * faster <= 1.0;
}

/// Replaces the given rows of `values` by average_ending. `values` has one column for each of `time_s`.
void average_rows(const Stream& stream, const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& time_s,
                  double step_s, Eigen::MatrixXd& values);

/// Zero-order hold: the value of the last sample at or before each of `time_s` (increasing); before the first sample,
/// its value. A sample that a time misses only by rounding counts as reached. Requires N >= 1.
Eigen::MatrixXd hold(const Stream& stream, const Eigen::VectorXd& time_s);

/// Weights of interpolated samples: the interpolated weights, but zero where a contributing sample has weight zero.
/// `weights` is 1 x N.
Eigen::VectorXd interpolate_weights(const Stream& weights, const Eigen::VectorXd& time_s);

/// Samples that are more than this many median periods of their stream apart have a gap between them.
inline constexpr double gap_periods = 5.0;

/// Standard deviation of the steps about their median, divided by the median, over all series. Gaps do not count as
/// steps. 0 without steps.
double step_scatter(const std::vector<const Eigen::VectorXd*>& times_s);

/// Largest scatter of the steps at which modes are searched. A model holds for one step length; with mixed step lengths
/// one motion looks like several.
inline constexpr double most_step_scatter = 0.1;

/// Replaces by NaN the values that were interpolated across a gap of their stream (`stream_time_s`, increasing).
void blank_gaps(const Eigen::VectorXd& stream_time_s, const Eigen::VectorXd& time_s, Eigen::MatrixXd& values);

struct JoinTimes {
  double rate_hz = 0.0;  ///< 0: the inputs' own times; else first common time + k / rate_hz
  double lag_s = 0.0;    ///< the input acting at time t is u(t - lag(t)), lag = lag_s + drift (t - reference_s)
  double drift = 0.0;
  double reference_s = 0.0;
};

/// The times that both streams cover once the inputs are delayed: first <= t <= last of the states, and first <= t -
/// lag(t) <= last of the inputs. May be empty. Requires drift < 1.
Eigen::VectorXd joint_times(const Eigen::VectorXd& states_time_s, const Eigen::VectorXd& inputs_time_s,
                            const JoinTimes& options);

/// The inputs that act in the middle of each transition from time_s(k) to time_s(k + 1), after the delay by `clock`.
/// The last column assumes one more transition of the median period.
/// If the inputs come at these times and clock is 0, the result is the input of time_s(k). Otherwise the delay is
/// rounded to the nearest whole number of samples; holding at time_s(k) would round it up.
Eigen::MatrixXd hold_mid_transition(const Stream& inputs, const Eigen::VectorXd& time_s, const InputClock& clock);

}  // namespace modebank
