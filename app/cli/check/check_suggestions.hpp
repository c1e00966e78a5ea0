#pragma once

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

}  // namespace modebank::app
