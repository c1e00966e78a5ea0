#pragma once

#include <cmath>

/// The numbers that keep a filter's arithmetic sound, whatever it is fed: of the equations and of the vector kernels
/// (which know nothing of Eigen).
namespace modebank {

/// No mode ever dies for good: probabilities after a measurement are kept above this, then renormalised.
inline constexpr double mode_probability_floor = 1e-12;

/// A mode whose probability is below this before a measurement is impossible (T forbids it): it takes no part.
inline constexpr double impossible_probability = 1e-100;

/// Beyond this variance, or its root for the mean, a diverging prediction stops growing, so that squares stay finite.
inline constexpr double largest_variance = 1e60;
inline constexpr double largest_mean = 1e30;

/// The least variance (a standard deviation of 1e-20 in the signal's unit), for S = 0.
inline constexpr double least_variance = 1e-40;

/// Log densities below this are not told apart.
inline constexpr double lowest_log_density = -1e300;

/// Measurements at or beyond this magnitude, infinite or NaN count as missing: nothing can be learned from them.
inline constexpr double largest_measurement = 1e30;

inline bool is_missing(double y) { return !(std::abs(y) < largest_measurement); }

/// How many entries of a measurement are missing.
template <class Y>
auto missing_entries(const Y& y) {
  decltype(y.size()) count = 0;
  for (decltype(y.size()) i = 0; i < y.size(); ++i) count += is_missing(y(i)) ? 1 : 0;
  return count;
}

/// Pivots of a covariance below this share of their diagonal entry are rounding noise: they are raised to it, which is
/// the same as adding that much to the diagonal.
inline constexpr double relative_pivot_floor = 1e-14;

/// To adaptive noise innovations count as no larger than this many standard deviations, so that one outlier does not
/// blow up the scale.
inline constexpr double largest_standardised = 5.0;

}  // namespace modebank
