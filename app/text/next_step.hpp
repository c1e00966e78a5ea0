#pragma once

#include <map>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Restarts that are advised, or tried, once: what does not help then never does.
inline constexpr int many_restarts = 20;

/// Resolved keys and their values, as the archive's configuration has them.
using Settings = std::map<std::string, std::string>;

/// What to do about a run, in one sentence with the option or the command: the first rule that applies of the table in
/// next_step.cpp. Empty without a scored bank.
std::string next_step(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
