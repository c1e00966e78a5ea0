#pragma once

#include <filesystem>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// Calls load_config, then checks that the values fit each other. If an override does not fit the file, the
/// ConfigurationError names the keys of the file that must also be set.
Config load_valid_config(const std::filesystem::path& path, const KeyValues& overrides);

}  // namespace modebank::app
