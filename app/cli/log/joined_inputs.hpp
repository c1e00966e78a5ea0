#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/init/proposal.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank::app {

/// Removes an input channel from all runs.
void remove_input(Recording& recording, Index input);

/// Leaves out inputs that the training runs cannot tell from other columns (ident/lag/identifiable.hpp), and states
/// each as a doubt with its equation: a set point that acts through a logged actuator, a sum of other inputs. Inputs
/// that the user `stated` stay. Throws DataError where a controller computes an input from the states alone. `file` and
/// `archive`: as in LogConfiguration::config. `typed`: the command line.
void leave_out_joined_inputs(const std::filesystem::path& file, const std::filesystem::path& archive,
                             const std::string& typed, bool stated, Proposal& proposal);

/// Inputs that never move in the training runs, and what these cannot tell apart, one sentence for each.
std::vector<std::string> joined_doubts(const Recording& recording);

}  // namespace modebank::app
