#pragma once

#include <cmath>
#include <limits>

namespace modebank {

/// Marks a number that could not be computed; archives store it unchanged.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// a < b, where NaN (a failed computation) is less than every number. So a failed candidate is never the best if
/// another candidate succeeded.
inline bool is_below(double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; }

}  // namespace modebank
