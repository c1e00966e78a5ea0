#pragma once

#include <filesystem>
#include <vector>

#include "app/config/config.hpp"

namespace modebank::app {

/// Prints which files a command would read and write, and which of these are there. Returns the exit status 0; throws
/// what finding the data throws.
int print_dry_run(const Config& config, const std::vector<std::filesystem::path>& written);

}  // namespace modebank::app
