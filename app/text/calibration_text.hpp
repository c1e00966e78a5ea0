#pragma once

#include <string>
#include <vector>

#include "app/text/errors_ahead.hpp"
#include "filter/judge/diagnostics.hpp"

/// Sentences on the stated uncertainty of a filter. Each is made from one row of /evaluation/diagnostics.
namespace modebank::app {

/// The verdict with its reason, such as "calibrated (92.5 to 97.5 % passes)".
std::string verdict_text(const DiagnosticsRow& row);
/// Text such as "96.6 % (95.6 to 97.4) of the held-out samples lie in the 95 % band one step ahead, 91.0 % 10 ahead:
/// calibrated, ...". The brackets contain the 95 % interval of the percentage.
std::string band_text(const DiagnosticsRow& row, const std::vector<ErrorAhead>& errors);

}  // namespace modebank::app
