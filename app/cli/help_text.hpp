#pragma once

#include <string>

namespace modebank::app {

/// All commands, a line each.
std::string help_overview();

/// What a command, a section, a key or a term is; the terms' definitions are those that pages show. Throws
/// ConfigurationError, naming the nearest, for what is none of them.
std::string help_on(const std::string& name);

/// All keys as a table: the documentation's reference.
std::string option_markdown();

}  // namespace modebank::app
