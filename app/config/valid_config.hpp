#pragma once

#include <filesystem>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// load_config, whose values fit each other. Where it is an override that does not fit what the file says, the
/// ConfigurationError names the keys of the file that would have to be set, too.
Config load_valid_config(const std::filesystem::path& path, const KeyValues& overrides);

}  // namespace modebank::app
