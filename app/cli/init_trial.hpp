#pragma once

#include <filesystem>
#include <string>

#include "app/init/proposal.hpp"

namespace modebank::app {

/// Returns the error with which `run` would refuse the configuration before any fit, apart from the lag; empty if `run`
/// accepts it. `target`: path of the configuration file.
std::string refusal(const Proposal& proposal, const std::filesystem::path& target);

/// Removes keys that no longer exist. Quotes values that the parser of a configuration line would cut or trim.
void state_values(Proposal& proposal);

/// Changes the proposal until `run` accepts it. Each change adds a doubt with the reason. Throws DataError with the
/// reason if no change helps.
void make_it_run(Proposal& proposal, const std::filesystem::path& target);

}  // namespace modebank::app
