#pragma once

#include <filesystem>

#include "app/config/config.hpp"

namespace modebank::app {

/// Reads the parameters of the system that simulate.system names. This is a file relative to `folder` with a section
/// [system], or one of the program's own (configs/systems). Throws ConfigurationError with file and line. Also throws
/// for a parameter that the system's kind does not have.
void read_system(const std::filesystem::path& folder, Config& config);

}  // namespace modebank::app
