#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/cli/check/suggest.hpp"
#include "app/config/config.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

/// The keys that a change from one set of settings to another sets, with their values.
KeyValues changed_keys(const Config& config, const Settings& from, const Settings& to);

/// Why a change was tried.
std::string reason_text(const Trial& trial);

/// Its gain, by which runs, and why it was tried; or why it has no gain.
std::string gain_reason(const Suggestions& suggestions, const Trial& trial);

/// What is suggested, with its gains, and what was tried in vain.
std::string suggestions_text(const Suggestions& suggestions, const Config& config);
nlohmann::json suggestions_json(const Suggestions& suggestions, const Config& config);

/// The configuration file with what the command line set and what is suggested, to stand as `output`. Throws
/// ConfigurationError where a path cannot be written into a configuration.
std::string applied_text(const Suggestions& suggestions, const Config& config, const std::filesystem::path& file,
                         const KeyValues& overrides, const std::filesystem::path& output);

}  // namespace modebank::app
