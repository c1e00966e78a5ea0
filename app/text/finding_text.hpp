#pragma once

#include <string>

#include "filter/judge/decide/finding.hpp"

namespace modebank {

/// A finding in plain sentences: the answer with the gain and its standard error, what describes the runs instead, and
/// where a competitor predicts the mean better.
std::string finding_text(const Finding& finding);

}  // namespace modebank
