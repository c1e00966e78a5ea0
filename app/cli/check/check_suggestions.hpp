#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli/check/suggest.hpp"
#include "app/config/config.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

/// Keys, with values, that change one set of settings into another.
KeyValues changed_keys(const Config& config, const Settings& from, const Settings& to);

/// Reason for a trial.
std::string reason_text(const Trial& trial);

/// The trial's gain with its runs and reason; or the reason why it has no gain.
std::string gain_reason(const Suggestions& suggestions, const Trial& trial);

/// Text on the suggestions with their gains, and on trials without improvement.
std::string suggestions_text(const Suggestions& suggestions, const Config& config);
nlohmann::json suggestions_json(const Suggestions& suggestions, const Config& config);

/// The configuration file with the command line's keys and the suggestions, to be written as `output`. Throws
/// ConfigurationError for a path that a configuration cannot contain.
std::string applied_text(const Suggestions& suggestions, const Config& config, const std::filesystem::path& file,
                         const KeyValues& overrides, const std::filesystem::path& output);

}  // namespace modebank::app
