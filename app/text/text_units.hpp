#pragma once

namespace modebank::app {

/// Factors for printing shares.
inline constexpr double percent = 1e2;
inline constexpr double per_mille = 1e3;

}  // namespace modebank::app
