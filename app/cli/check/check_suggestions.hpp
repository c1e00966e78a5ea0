#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli/check/suggest.hpp"
#include "app/config/config.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

/// Keys and values that turn the settings `from` into `to`.
KeyValues changed_keys(const Config& config, const Settings& from, const Settings& to);

/// Reason for a trial.
std::string reason_text(const Trial& trial);

/// The trial's gain, the number of runs and the reason. Without a gain, the reason why there is none.
std::string gain_reason(const Suggestions& suggestions, const Trial& trial);

/// Text on the suggestions with their gains, and on the trials that gained nothing.
std::string suggestions_text(const Suggestions& suggestions, const Config& config);
nlohmann::json suggestions_json(const Suggestions& suggestions, const Config& config);

/// Content of the file `output`: the configuration file with the keys of the command line and the suggestions. Throws
/// ConfigurationError for a path that a configuration cannot contain.
std::string applied_text(const Suggestions& suggestions, const Config& config, const std::filesystem::path& file,
                         const KeyValues& overrides, const std::filesystem::path& output);

}  // namespace modebank::app
