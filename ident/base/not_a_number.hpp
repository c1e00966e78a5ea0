#pragma once

#include <cmath>
#include <limits>

namespace modebank {

/// Marks a number that could not be computed; archives store it unchanged.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// a < b, with NaN (a failed computation) below every number. So a failed candidate is never the best if another one
/// succeeded.
inline bool is_below(double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; }

}  // namespace modebank
