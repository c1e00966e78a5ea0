#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/diagnostics.hpp"

namespace modebank {

/// What stands out of a filter's row, separated by "; ". `modes`: rows of the same filter's modes. `nees_states`: how
/// many states the NEES is about.
std::string flags_of(const DiagnosticsRow& all, const std::vector<DiagnosticsRow>& modes, Eigen::Index nees_states);

}  // namespace modebank
