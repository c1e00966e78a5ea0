#pragma once

namespace modebank {

/// A standard normal variable that is known to lie in an interval.
struct TruncatedNormal {
  double log_mass = 0.0;  ///< log of the interval's probability
  double mean = 0.0;
  double variance = 0.0;  ///< in (0, 1]
};

/// Of [low, high], low <= high: however narrow (a point counts as of the least mass that is a number), and however far
/// out in a tail, to about twelve digits (the mass to fourteen). Bounds beyond 1e100 count as that.
TruncatedNormal truncated_normal(double low, double high);

}  // namespace modebank
