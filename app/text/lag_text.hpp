#pragma once

#include <string>

#include "ident/lag/report.hpp"

namespace modebank::app {

/// Summary of data.lag_s = auto: pooled estimates, scores, estimates per run. `done`: the correction was applied, not
/// only proposed.
std::string lag_text(const LagReport& report, bool done = true);

/// "+0.123 +- 0.004", or "-" with the reason where the estimate is not valid.
std::string lag_estimate_text(double lag_s, double standard_error_s, LagStatus status);

}  // namespace modebank::app
