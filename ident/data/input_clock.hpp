#pragma once

namespace modebank {

/// When inputs act on the states' clock: the input in force at time t is u(t - at(t)). Positive: inputs act later than
/// their stamps say; negative: earlier (the inputs' stamps are late).
struct InputClock {
  double lag_s = 0.0;        ///< at reference_s
  double drift = 0.0;        ///< of the lag [s/s]
  double reference_s = 0.0;  ///< on the states' clock

  double at(double time_s) const { return lag_s + drift * (time_s - reference_s); }
};

}  // namespace modebank
