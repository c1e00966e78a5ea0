#pragma once

namespace modebank::app {

/// Factor from a fraction to percent.
inline constexpr double percent = 1e2;

}  // namespace modebank::app
