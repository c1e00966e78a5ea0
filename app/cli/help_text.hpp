#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// All commands, one line each.
std::string help_overview();

/// Explains a command, a section, a key, a label of the screen or a term. The pages of `report` show the same
/// definitions. Throws ConfigurationError with the nearest names for an unknown word.
std::string help_on(const std::string& name);

/// A table of all keys, for the documentation.
std::string option_markdown();

/// The words of the glossary that `help_on` explains.
std::vector<std::string> term_names();

}  // namespace modebank::app
