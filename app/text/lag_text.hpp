#pragma once

#include <string>

#include "ident/lag/report.hpp"

namespace modebank::app {

/// What data.lag_s = auto found and did (or would do), in a few lines: pooled estimates, scores, and per run in short.
std::string lag_text(const LagReport& report, bool done = true);

/// "+0.123 +- 0.004", or "-" with the reason where the number means nothing.
std::string lag_estimate_text(double lag_s, double standard_error_s, LagStatus status);

}  // namespace modebank::app
