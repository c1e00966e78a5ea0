#pragma once

#include <string>
#include <string_view>

#include "ident/base/characters.hpp"

namespace modebank {

/// The text in UTF-8, safe for a terminal. Control characters (except line ends and tabs) and bytes that are not UTF-8
/// become escapes such as \x1b.
std::string printable(std::string_view text);

/// The name, safe for one line of a log, a table or a job script: `printable` with line ends and tabs also escaped
/// (\x0a).
std::string printable_name(std::string_view text);

/// Whether `printable` or `printable_name` would escape a character of the text. Bytes that are not UTF-8 do not count.
bool holds_controls(std::string_view text);
bool name_holds_controls(std::string_view text);

}  // namespace modebank
