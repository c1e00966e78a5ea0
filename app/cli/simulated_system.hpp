#pragma once

#include <filesystem>

#include "app/config/config.hpp"

namespace modebank::app {

/// Reads the parameters of the system that simulate.system names. The name is a file with a section [system], relative
/// to `folder`, or a built-in system (configs/systems). Throws ConfigurationError with file and line, also for a
/// parameter that this kind of system does not have.
void read_system(const std::filesystem::path& folder, Config& config);

}  // namespace modebank::app
