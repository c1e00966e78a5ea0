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

/// Origin of each value: "robot.ini:12" or "--window.length", else default. A repeatable key has one line per value.
using Origins = std::map<std::string, std::string>;

/// Reads a configuration file as Boost.Program_options does, then applies the overrides (the command line wins).
/// data.root becomes absolute: as configured, else $MODEBANK_DATA, else the file's folder. Throws ConfigurationError
/// naming line, key and, for an unknown key, the nearest known one.
Config load_config(const std::filesystem::path& path, const KeyValues& overrides, Origins* origins = nullptr);

/// Reads a text as load_config reads the file `path`. The text need not be written there yet.
Config config_of_text(const std::string& bytes, const std::filesystem::path& path, const KeyValues& overrides,
                      Origins* origins = nullptr);

/// Whether a name ends as those of logs do: .csv, .bag and others.
bool has_ending_of_logs(const std::filesystem::path& path);
/// Whether a file is a log, by its name or because it contains bytes that no text has.
bool looks_like_log(const std::filesystem::path& path);

/// The [data] and [filter] keys and the seed of an archive's configuration, then the overrides. Keys that this version
/// does not have are left out.
Config stored_config(const std::string& resolved, const KeyValues& overrides);

/// Reads a whole resolved configuration back. Keys that this version does not have are left out.
Config resolved_config(const std::string& resolved);

/// Every key with its value, itself a valid configuration file.
std::string resolved_text(const Config& config);

/// Key and value of every line of a resolved configuration.
std::map<std::string, std::string> resolved_values(const std::string& resolved);

/// Whether a key can change a number of a run: its row of the option table names a stage.
bool decides_numbers(const std::string& key);

/// SHA-256 over the resolved keys that determine numbers, in name order.
std::string config_hash(const Config& config);

/// Throws ConfigurationError, beginning with `where`, for a text outside the option's range. `has_comment`: a comment
/// followed in the same line.
void set_option(Config& config, const Option& option, const std::string& where, const std::string& value,
                bool has_comment);

/// ", did you mean window.length?", or the replacement of a key that was removed; empty when no known key is close.
std::string nearest_key_hint(const std::string& key);

}  // namespace modebank::app
