#pragma once

#include <string>
#include <vector>

#include "ident/trajectory.hpp"

namespace modebank {

std::vector<std::string> run_names(const std::vector<Trajectory>& runs);

/// Run names become groups of the archive. Throws DataError for a name that cannot be one ('/' is a level there, "."
/// and
/// ".." are groups already, texts end at a zero byte, "*" is all runs in the summary) or that two runs share.
void check_run_names(const std::vector<std::string>& names);

}  // namespace modebank
