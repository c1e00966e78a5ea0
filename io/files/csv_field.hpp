#pragma once

#include <string>
#include <string_view>

namespace modebank {

/// A field of CSV as RFC 4180 has it: in quotes where it holds a comma, a quote or a line break. For files that
/// programs read back.
std::string quoted_field(std::string_view text);

/// The same for tables that people open. An apostrophe goes in front of a text that a spreadsheet would take for a
/// formula: it begins with = + - @, a tab or a carriage return, and does not read as a number.
std::string csv_field(std::string_view text);

}  // namespace modebank
