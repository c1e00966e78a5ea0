#pragma once

#include "app/cli/command_line.hpp"
#include "app/cli/command_table.hpp"

namespace modebank::app {

/// Throws ConfigurationError for an option that the command does not read, saying which it does.
void check_options(const Command& command, const CommandLine& line);

}  // namespace modebank::app
