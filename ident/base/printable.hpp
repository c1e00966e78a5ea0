#pragma once

#include <string>
#include <string_view>

#include "ident/base/characters.hpp"

namespace modebank {

/// The text as a terminal may be given it: control characters but line ends and tabs as \x1b.
std::string printable(std::string_view text);

/// A name as a line of a log, a table or a job script can hold it: line ends and tabs too are shown as \x0a.
std::string printable_name(std::string_view text);

}  // namespace modebank
