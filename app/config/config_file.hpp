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

/// Origin of each value: "robot.ini:12" or "--window.length"; otherwise the default. A repeatable key has one line per
/// value.
using Origins = std::map<std::string, std::string>;

/// Reads a configuration file as Boost.Program_options does, then applies the overrides of the command line, which have
/// priority. data.root becomes absolute: the configured folder, else $MODEBANK_DATA, else the file's folder. Throws
/// ConfigurationError with the line and the key. For an unknown key it names the nearest known key.
Config load_config(const std::filesystem::path& path, const KeyValues& overrides, Origins* origins = nullptr);

/// Reads a text as load_config would read the file `path`. The file need not exist yet.
Config config_of_text(const std::string& bytes, const std::filesystem::path& path, const KeyValues& overrides,
                      Origins* origins = nullptr);

/// Whether a file name has the extension of a log: .csv, .bag and others.
bool has_ending_of_logs(const std::filesystem::path& path);
/// Whether a file is a log, by its name or because it contains bytes that no text contains.
bool looks_like_log(const std::filesystem::path& path);

/// Whether a text file consists of sections and keys, with at least one known key, or has a line [data].
bool is_configuration(const std::filesystem::path& path);

/// Same as check_output, for a configuration. Users may have edited an existing file, so only `force` replaces it.
void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force);

/// The [data] and [filter] keys and the seed from an archive's configuration, then the overrides. Keys that this
/// version does not have are ignored.
Config stored_config(const std::string& resolved, const KeyValues& overrides);

/// Reads a whole resolved configuration. Keys that this version does not have are ignored.
Config resolved_config(const std::string& resolved);

/// Every key with its value. The text is a valid configuration file.
std::string resolved_text(const Config& config);

/// Key and value of every line of a resolved configuration.
std::map<std::string, std::string> resolved_values(const std::string& resolved);

/// Whether a key can affect a number of a run. If so, its row in the option table names a stage.
bool decides_numbers(const std::string& key);

/// SHA-256 of the resolved keys that determine numbers, in the order of their names.
std::string config_hash(const Config& config);

/// Throws ConfigurationError for a value outside the option's range; the message begins with `where`. `has_comment`:
/// whether a comment followed in the same line.
void set_option(Config& config, const Option& option, const std::string& where, const std::string& value,
                bool has_comment);

/// End of a message: ", did you mean window.length?", or the replacement of a key that was removed. Empty if no known
/// key is similar.
std::string nearest_key_hint(const std::string& key);

}  // namespace modebank::app
