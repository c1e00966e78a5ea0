#pragma once

#include <string>

#include "ident/fit/lag_counts.hpp"

namespace modebank::app {

/// What window.state_lags = auto and window.input_lags = auto found, a line each.
std::string lag_counts_text(const LagCounts& found);

}  // namespace modebank::app
