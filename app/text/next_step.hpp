#pragma once

#include <map>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Resolved keys and their values, from the configuration in the archive.
using Settings = std::map<std::string, std::string>;

/// One sentence of advice on a run, with the option or command to type. It comes from the first rule in next_step.cpp
/// that applies. Empty without a scored bank.
std::string next_step(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
