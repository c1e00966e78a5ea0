#pragma once

namespace modebank {

/// Delay of the inputs on the states' clock. The input that acts at time t is u(t - at(t)). With a positive delay,
/// inputs act later than their stamps. With a negative delay, they act earlier than their stamps, because the stamps
/// are late.
struct InputClock {
  double lag_s = 0.0;        ///< lag at reference_s
  double drift = 0.0;        ///< rate of change of the lag [s/s]
  double reference_s = 0.0;  ///< reference time on the states' clock

  double at(double time_s) const { return lag_s + drift * (time_s - reference_s); }
};

}  // namespace modebank
