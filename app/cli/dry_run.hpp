#pragma once

#include <filesystem>
#include <vector>

#include "app/cli/result.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Which files a command would read and write, and which of these are there. Throws what finding the data throws.
Result dry_run(const Config& config, const std::vector<std::filesystem::path>& written);

}  // namespace modebank::app
