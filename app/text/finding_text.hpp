#pragma once

#include <string>

#include "filter/judge/decide/finding.hpp"

namespace modebank {

/// A finding in plain sentences: the answer with the gain over the best competitor and its standard error, and the
/// single model that describes the runs instead.
std::string finding_text(const Finding& finding);

}  // namespace modebank
