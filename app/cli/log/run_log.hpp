#pragma once

#include <string>
#include <vector>

#include "app/cli/command_line.hpp"
#include "app/cli/result.hpp"

/// `modebank run LOG...`: the proposal of `init`, further decisions on training runs left out, then `run` and `report`.
namespace modebank::app {

/// Whether one of the files given to `run` is a log or a folder, not a configuration.
bool names_logs(const std::vector<std::string>& files);

/// Writes NAME.ini, NAME.h5 and NAME.html. Before any fit, prints the channels and runs that it uses. Throws
/// ConfigurationError at once if one of the files exists and --force was not given.
Result do_run_log(const CommandLine& line);

}  // namespace modebank::app
