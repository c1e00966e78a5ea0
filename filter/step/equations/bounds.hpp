#pragma once

#include <cmath>

/// Limits that keep a filter's arithmetic stable for any input.
namespace modebank {

/// Lower bound of mode probabilities after a measurement, so that every mode can recover. Probabilities are then
/// renormalised.
inline constexpr double mode_probability_floor = 1e-12;

/// A mode with a smaller probability before a measurement is impossible (T forbids it). The filter skips such a mode.
inline constexpr double impossible_probability = 1e-100;

/// Upper bound of variances in a diverging prediction, so that squares stay finite. Means are bounded by the square
/// root of this bound.
inline constexpr double largest_variance = 1e60;
inline constexpr double largest_mean = 1e30;

/// Smallest variance. It is used if S = 0. The standard deviation is 1e-20 in the signal's unit.
inline constexpr double least_variance = 1e-40;

/// Lower bound of log densities.
inline constexpr double lowest_log_density = -1e300;

/// Log density of a measurement. NaN, from an overflow, has the lowest value, too: a filter that failed at a sample is
/// not one that did not measure it.
inline double measured_density(double value) { return value > lowest_log_density ? value : lowest_log_density; }

/// A measurement counts as missing if it is NaN, infinite, or at least this large.
inline constexpr double largest_measurement = 1e30;

inline bool is_missing(double y) { return !(std::abs(y) < largest_measurement); }

/// Number of missing entries in a measurement.
template <class Y>
auto missing_entries(const Y& y) {
  decltype(y.size()) count = 0;
  for (decltype(y.size()) i = 0; i < y.size(); ++i) count += is_missing(y(i)) ? 1 : 0;
  return count;
}

/// Smallest pivot of a covariance, as a share of its diagonal entry. Smaller pivots are rounding errors. Raising a
/// pivot to this bound is the same as adding the difference to the diagonal.
inline constexpr double relative_pivot_floor = 1e-14;

}  // namespace modebank
