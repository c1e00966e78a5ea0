#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Assigns roles; runs without a role are left out. If both lists are empty, positions 0, 2, 4, ... of `runs` (in name
/// order) train and the others test. If one list is empty, it stands for all runs that the other list does not name.
/// Throws ConfigurationError with the runs for a name that is unknown or given twice.
std::vector<std::optional<Role>> assign_roles(const std::vector<std::string>& runs,
                                              const std::vector<std::string>& train,
                                              const std::vector<std::string>& test);

}  // namespace modebank
