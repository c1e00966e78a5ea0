#pragma once

#include <string>

#include "filter/judge/finding.hpp"

namespace modebank {

/// A finding in sentences: the answer, and the gain over the best competitor with its standard error. A single model
/// that describes the runs as well or better is named, too.
std::string finding_text(const Finding& finding);

}  // namespace modebank
