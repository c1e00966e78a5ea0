#pragma once

#include <map>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Number of restarts to advise or try. It is tried once: if this number does not help, a larger one does not help
/// either.
inline constexpr int many_restarts = 20;

/// Resolved keys with their values, from the archive's configuration.
using Settings = std::map<std::string, std::string>;

/// One sentence of advice on a run, with the option or command. It comes from the first rule in next_step.cpp that
/// applies. Empty without a scored bank.
std::string next_step(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
