#pragma once

#include <string>

#include "filter/judge/decide/finding.hpp"

namespace modebank {

/// A finding in sentences: the answer, the gain over the best competitor with its standard error, and any single model
/// that describes the runs as well or better.
std::string finding_text(const Finding& finding);

}  // namespace modebank
