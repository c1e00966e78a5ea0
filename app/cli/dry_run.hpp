#pragma once

#include <filesystem>
#include <vector>

#include "app/cli/result.hpp"
#include "app/config/config.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

/// Files that a command would read and write, and whether these exist. Throws the exceptions of the search for data.
Result dry_run(const Config& config, const std::vector<std::filesystem::path>& written);

/// Adds every key with its value and its origin. The text is then a valid configuration, with comments.
void add_values(const Config& config, const Origins& origins, Result& result);

}  // namespace modebank::app
