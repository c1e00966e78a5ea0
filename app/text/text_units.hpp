#pragma once

namespace modebank::app {

/// Factor from a fraction to percent.
inline constexpr double percent = 1e2;
inline constexpr double per_mille = 1e3;

}  // namespace modebank::app
