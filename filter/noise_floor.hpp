#pragma once

#include <algorithm>

namespace modebank {

/// Smallest eigenvalue of a mode's Q, as a share of the global residual variance of each state: below it a mode would
/// claim that its transitions are exact, which only a handful of transitions can seem to be.
inline constexpr double process_noise_floor = 1e-6;

/// Share of a variance that is rounding (a millionth of the standard deviation): keeps a variance positive where the
/// data ask for none, without shaping any that they do ask for.
inline constexpr double rounding_share = 1e-12;

/// A residual variance as the unit of the two shares above: itself, but positive on exact data, so that inverses stay
/// finite.
inline double positive_variance(double variance) { return std::max(variance, 1e-100); }

}  // namespace modebank
