#pragma once

#include <string>
#include <string_view>

namespace modebank {

/// A field of CSV by RFC 4180: in quotes if it contains a comma, a quote or a line break. For files that programs read.
std::string quoted_field(std::string_view text);

/// The same for tables that people open. A text that a spreadsheet would execute as a formula gets an apostrophe in
/// front. Such a text begins with = + - @, a tab or a carriage return, and is not a number.
std::string csv_field(std::string_view text);

}  // namespace modebank
