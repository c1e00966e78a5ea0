#pragma once

#include <array>
#include <cstddef>

#include "filter/judge/score/squared_distances.hpp"

namespace modebank {

/// The central bands whose coverage is counted, and which of them decides.
inline constexpr std::array<double, 4> coverage_levels{0.50, 0.90, 0.95, 0.99};
inline constexpr std::size_t deciding_level = 2;

/// Of |z|: normal quantiles.
std::array<double, coverage_levels.size()> coverage_band_edges();

/// Limits of the probability behind `count` successes in `samples` independent trials, Clopper & Pearson (1934).
/// Fractions of trials are allowed. NaN without samples.
Interval binomial_interval(double count, double samples, double level = 0.95);

}  // namespace modebank
