#pragma once

#include <cmath>
#include <limits>

namespace modebank {

/// What stands where a number could not be computed; archives store it as it is.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// a < b, where NaN, of what failed, is below every number: the best of several is then never one that failed while
/// another did not.
inline bool is_below(double a, double b) { return std::isnan(a) ? !std::isnan(b) : a < b; }

}  // namespace modebank
