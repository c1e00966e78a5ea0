#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// All commands, a line each.
std::string help_overview();

/// Explains a command, a section, a key, a label of the screen or a term; pages show the same definitions of terms.
/// Throws ConfigurationError, naming the nearest, for what is none of them.
std::string help_on(const std::string& name);

/// All keys as a table: the documentation's reference.
std::string option_markdown();

/// The words of the glossary that help_on explains.
std::vector<std::string> term_names();

}  // namespace modebank::app
