#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Assigns roles. Runs without a role are removed.
/// If both lists are empty, positions 0, 2, 4, ... of `runs` (in name order) are training runs, and the others are test
/// runs. If one list is empty, it means all runs that are not in the other list. Throws ConfigurationError, which lists
/// the runs, if a name is unknown or repeated.
std::vector<std::optional<Role>> assign_roles(const std::vector<std::string>& runs,
                                              const std::vector<std::string>& train,
                                              const std::vector<std::string>& test);

}  // namespace modebank
