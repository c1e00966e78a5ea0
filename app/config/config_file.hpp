#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config.hpp"

namespace modebank::app {

struct Option;

using KeyValues = std::vector<std::pair<std::string, std::string>>;

/// Where each value comes from: "robot.ini:12", "--window.length" (lines for those of a repeatable key); else default.
using Origins = std::map<std::string, std::string>;

/// Reads a configuration file as Boost.Program_options does, then applies the overrides (the command line wins).
/// data.root becomes absolute: as configured, else $MODEBANK_DATA, else the file's folder. Throws ConfigurationError
/// naming line, key and, for an unknown key, the nearest known one.
Config load_config(const std::filesystem::path& path, const KeyValues& overrides, Origins* origins = nullptr);

/// Reads a text as load_config reads the file `path`, in which it stands or is to stand.
Config config_of_text(const std::string& bytes, const std::filesystem::path& path, const KeyValues& overrides,
                      Origins* origins = nullptr);

/// Whether a file is a log by its name, or because it holds bytes that no text has.
bool looks_like_log(const std::filesystem::path& path);

/// The [data] and [filter] keys and the seed of a configuration that an archive holds, then the overrides. Keys that
/// this version does not know are left out.
Config stored_config(const std::string& resolved, const KeyValues& overrides);

/// A resolved configuration read back whole. Keys that this version does not know are left out.
Config resolved_config(const std::string& resolved);

/// Every key with its value, itself a valid configuration file.
std::string resolved_text(const Config& config);

/// Key and value of every line of a resolved configuration.
std::map<std::string, std::string> resolved_values(const std::string& resolved);

/// Whether a key can change a number of a run: its row of the option table names a stage.
bool decides_numbers(const std::string& key);

/// SHA-256 over the resolved keys that decide numbers, in name order.
std::string config_hash(const Config& config);

/// Throws ConfigurationError, which begins with `where`, for a text that is not in the option's range. `has_comment`:
/// that one followed in its line.
void set_option(Config& config, const Option& option, const std::string& where, const std::string& value,
                bool has_comment);

/// ", did you mean window.length?", or of a key that went what takes its place; nothing when no known key is close.
std::string nearest_key_hint(const std::string& key);

}  // namespace modebank::app
