#pragma once

namespace modebank::app {

/// Factors from shares to what is printed.
inline constexpr double percent = 1e2;
inline constexpr double per_mille = 1e3;

}  // namespace modebank::app
