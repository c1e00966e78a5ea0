#pragma once

#include <cmath>

/// Limits that keep a filter's arithmetic stable for any input, shared by the equations and the vector kernels (which
/// do not use Eigen).
namespace modebank {

/// Lower bound of mode probabilities after a measurement (then renormalised), so that every mode can recover.
inline constexpr double mode_probability_floor = 1e-12;

/// A mode with a smaller probability before a measurement is impossible (T forbids it) and is skipped.
inline constexpr double impossible_probability = 1e-100;

/// Upper bound of variances in a diverging prediction, so that squares stay finite. Its square root bounds the means.
inline constexpr double largest_variance = 1e60;
inline constexpr double largest_mean = 1e30;

/// Smallest variance (a standard deviation of 1e-20 in the signal's unit), used if S = 0.
inline constexpr double least_variance = 1e-40;

/// Lower bound of log densities.
inline constexpr double lowest_log_density = -1e300;

/// Measurements of at least this magnitude, infinite or NaN count as missing.
inline constexpr double largest_measurement = 1e30;

inline bool is_missing(double y) { return !(std::abs(y) < largest_measurement); }

/// Number of missing entries in a measurement.
template <class Y>
auto missing_entries(const Y& y) {
  decltype(y.size()) count = 0;
  for (decltype(y.size()) i = 0; i < y.size(); ++i) count += is_missing(y(i)) ? 1 : 0;
  return count;
}

/// Smallest pivot of a covariance as a share of its diagonal entry; smaller pivots are rounding. Raising a pivot to
/// this bound is the same as adding the difference to the diagonal.
inline constexpr double relative_pivot_floor = 1e-14;

/// Largest innovation for adaptive noise, in standard deviations, so that one outlier does not inflate the scale.
inline constexpr double largest_standardised = 5.0;

}  // namespace modebank
