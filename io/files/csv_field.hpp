#pragma once

#include <string>
#include <string_view>

namespace modebank {

/// A CSV field by RFC 4180, for files that programs read. The field is in quotes if it contains a comma, a quote or a
/// line break.
std::string quoted_field(std::string_view text);

/// A CSV field for tables that people open. A text that a spreadsheet would execute as a formula gets an apostrophe in
/// front. Such a text is not a number and begins with = + - @, a tab or a carriage return.
std::string csv_field(std::string_view text);

}  // namespace modebank
