#pragma once

#include <limits>

namespace modebank {

/// What stands where a number could not be computed; archives store it as it is.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace modebank
