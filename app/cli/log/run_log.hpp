#pragma once

#include <string>
#include <vector>

#include "app/cli/command_line.hpp"
#include "app/cli/result.hpp"

/// `modebank run LOG...`: what `init` proposes, decided further by training runs that are left out, then `run` and
/// `report`.
namespace modebank::app {

/// Whether one of the files that `run` was given is a log, or a folder, and no configuration.
bool names_logs(const std::vector<std::string>& files);

/// Writes NAME.ini, NAME.h5 and NAME.html, and prints what was taken from the logs before anything is fitted. Throws
/// ConfigurationError, before anything is computed, where one of the files exists and --force was not given.
Result do_run_log(const CommandLine& line);

}  // namespace modebank::app
