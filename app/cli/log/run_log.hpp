#pragma once

#include <string>
#include <vector>

#include "app/cli/command_line.hpp"
#include "app/cli/result.hpp"

/// `modebank run LOG...` does four steps: the proposal of `init`, decisions on training runs left out, `run` and
/// `report`.
namespace modebank::app {

/// Whether one of the files given to `run` is a log or a folder of logs, and not a configuration.
bool names_logs(const std::vector<std::string>& files);

/// Writes NAME.ini, NAME.h5 and NAME.html. Before any fit, prints the channels and runs in use. Throws
/// ConfigurationError at once if one of the files exists and --force was not given.
Result do_run_log(const CommandLine& line);

}  // namespace modebank::app
