#pragma once

#include <Eigen/Core>

namespace modebank {

/// Signals that share their sample times, one sample per column.
struct Stream {
  Eigen::VectorXd time_s;  ///< N, strictly increasing
  Eigen::MatrixXd values;  ///< channels x N
};

/// Linear interpolation at `time_s` (increasing); outside the stream's span the nearest end's value, exactly as
/// numpy.interp. Requires N >= 1.
Eigen::MatrixXd interpolate(const Stream& stream, const Eigen::VectorXd& time_s);

/// Zero-order hold: the value of the last sample at or before each of `time_s` (increasing); before the first sample,
/// its value. Times that miss a sample by no more than rounding count as equal to it. Requires N >= 1.
Eigen::MatrixXd hold(const Stream& stream, const Eigen::VectorXd& time_s);

struct JoinTimes {
  double rate_hz = 0.0;  ///< 0: the inputs' own times; else first common time + k / rate_hz
  double lag_s = 0.0;    ///< the input in force at time t is u(t - lag_s)
};

/// The times that both streams cover once the inputs are delayed by lag_s: states' first <= t <= last, and
/// inputs' first <= t - lag_s <= last. May be empty.
Eigen::VectorXd joint_times(const Eigen::VectorXd& states_time_s, const Eigen::VectorXd& inputs_time_s,
                            const JoinTimes& options);

}  // namespace modebank
