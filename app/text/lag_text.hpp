#pragma once

#include <string>

#include "ident/lag/report.hpp"

namespace modebank::app {

/// Summary of data.lag_s = auto: pooled estimates, scores, estimates for each run. `done`: true if the correction was
/// applied, false if it was only proposed.
std::string lag_text(const LagReport& report, bool done = true);

/// Text such as "+0.123 +- 0.004", or "-" with the reason if the estimate is invalid.
std::string lag_estimate_text(double lag_s, double standard_error_s, LagStatus status);

}  // namespace modebank::app
