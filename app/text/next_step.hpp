#pragma once

#include <map>
#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Number of restarts to advise or try, once only: if these do not help, more do not either.
inline constexpr int many_restarts = 20;

/// Resolved keys with their values, from the archive's configuration.
using Settings = std::map<std::string, std::string>;

/// Advice on a run, in one sentence with the option or command: that of the first rule in next_step.cpp that applies.
/// Empty without a scored bank.
std::string next_step(const Archive& archive, const Settings& settings);

}  // namespace modebank::app
