#pragma once

#include <filesystem>
#include <string>

#include "app/init/proposal.hpp"

namespace modebank::app {

/// Leaves out inputs that the training runs cannot tell from other columns (ident/lag/identifiable.hpp), and states
/// each as a doubt with its equation: a set point that acts through a logged actuator, a sum of other inputs. Where the
/// user states the inputs, it only states the doubt. Throws DataError where a controller computes an input from the
/// states alone. `file` and `archive`: as in LogConfiguration::config. `typed`: the command line.
void leave_out_joined_inputs(const std::filesystem::path& file, const std::filesystem::path& archive,
                             const std::string& typed, bool stated, Proposal& proposal);

}  // namespace modebank::app
