#pragma once

#include <filesystem>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// load_config, then a check that the values fit each other. Where an override does not fit the file, the
/// ConfigurationError names the file's keys that must be set, too.
Config load_valid_config(const std::filesystem::path& path, const KeyValues& overrides);

}  // namespace modebank::app
