#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/config.hpp"

namespace modebank::app {

using KeyValues = std::vector<std::pair<std::string, std::string>>;

/// Reads a configuration file as Boost.Program_options does, then applies the overrides (the command line wins).
/// data.root becomes absolute: as configured, else $MODEBANK_DATA, else the file's folder. Throws ConfigurationError
/// naming line, key and, for an unknown key, the nearest known one.
Config load_config(const std::filesystem::path& path, const KeyValues& overrides);

/// Every key with its value, itself a valid configuration file.
std::string resolved_text(const Config& config);

/// SHA-256 over the resolved keys in name order, without data.root, archive.* and job.threads: what decides the
/// numbers.
std::string config_hash(const Config& config);

/// ", did you mean window.length?", or nothing when no known key is close.
std::string nearest_key_hint(const std::string& key);

}  // namespace modebank::app
