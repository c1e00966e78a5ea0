#pragma once

#include <string>

namespace modebank::app {

/// All option keys with range, unit, default and meaning, section by section.
std::string option_help();
/// The table of keys for the pages of docs/, so that it is this table and no other.
std::string option_markdown();

/// What a term or a key means: the one definition that pages show, too. Throws ConfigurationError, naming the nearest,
/// for what is neither.
std::string meaning_of(const std::string& name);

}  // namespace modebank::app
