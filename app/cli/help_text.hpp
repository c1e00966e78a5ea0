#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace modebank::app {

struct Option;

/// All commands, one line each.
std::string help_overview();

/// Explains a command, a section, a key or a term. The pages of `report` show the same
/// definitions. Throws ConfigurationError with the nearest names for an unknown word.
std::string help_on(const std::string& name);

/// The option with this key, or with these words among its other ones; null if there is none.
const Option* option_called(const std::string& words);

/// All commands, keys and terms, for scripts and for the documentation.
nlohmann::json help_json();

}  // namespace modebank::app
