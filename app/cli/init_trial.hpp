#pragma once

#include <filesystem>
#include <string>

#include "app/init/proposal.hpp"

namespace modebank::app {

/// The message with which `run` would refuse the configuration before it fits anything; empty if it would not. Reads
/// the configuration, imports the data and cuts windows, without an estimate of the lag. `target`: the configuration's
/// file.
std::string refusal(const Proposal& proposal, const std::filesystem::path& target);

/// Removes keys that the program no longer has, and quotes values that a line would cut or trim.
void state_values(Proposal& proposal);

/// Changes the proposal until `run` accepts it, and adds a doubt with each change and its reason. Throws DataError,
/// with the reason, if no change helps.
void make_it_run(Proposal& proposal, const std::filesystem::path& target);

}  // namespace modebank::app
