#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Who trains and who tests; runs without a role are left out. Both lists empty: of `runs`, which are in name order,
/// positions 0, 2, 4, ... train, the others test. One list empty: it stands for all runs that the other does not name.
/// Throws ConfigurationError, listing the runs, for a name that is unknown or given twice.
std::vector<std::optional<Role>> assign_roles(const std::vector<std::string>& runs,
                                              const std::vector<std::string>& train,
                                              const std::vector<std::string>& test);

}  // namespace modebank
