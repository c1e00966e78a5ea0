#pragma once

#include "app/command_line.hpp"
#include "app/config.hpp"
#include "io/archive.hpp"

namespace modebank::app {

/// Program, libraries, time and command line of this execution; the data's part is added on import.
Provenance make_provenance(const Config& config, const CommandLine& line);

}  // namespace modebank::app
