#pragma once

#include <filesystem>
#include <string>

#include "app/init/proposal.hpp"

namespace modebank::app {

/// Why `run` would refuse the configuration before it fits anything: it is read, its data are imported and cut into
/// windows. Empty where it would not. `target`: the configuration's file. The lag is not estimated.
std::string refusal(const Proposal& proposal, const std::filesystem::path& target);

/// Leaves out keys that the program no longer has, and quotes values that a line would cut or trim.
void state_values(Proposal& proposal);

/// Changes the proposal until `run` accepts it, with a doubt that says what and why. Throws DataError with the reason
/// where nothing helps.
void make_it_run(Proposal& proposal, const std::filesystem::path& target);

}  // namespace modebank::app
