#pragma once

#include <filesystem>
#include <vector>

#include "app/cli/result.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Files that a command would read and write, and whether these exist. Throws the exceptions of the search for data.
Result dry_run(const Config& config, const std::vector<std::filesystem::path>& written);

}  // namespace modebank::app
