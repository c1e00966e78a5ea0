#pragma once

#include <string>
#include <string_view>

#include "ident/base/characters.hpp"

namespace modebank {

/// The text as a terminal may be given it, in UTF-8: control characters but line ends and tabs, and bytes that are no
/// UTF-8, as \x1b.
std::string printable(std::string_view text);

/// A name as a line of a log, a table or a job script can hold it: line ends and tabs too are shown as \x0a.
std::string printable_name(std::string_view text);

/// Whether a text holds what printable, or printable_name, shows otherwise, bytes that are no UTF-8 aside.
bool holds_controls(std::string_view text);
bool name_holds_controls(std::string_view text);

}  // namespace modebank
