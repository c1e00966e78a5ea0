#pragma once

#include <string>
#include <string_view>

namespace modebank {

enum class NumberStatus { ok, missing, out_of_range, text };

struct ParsedNumber {
  double value = 0.0;
  NumberStatus status = NumberStatus::ok;
};

/// Without blanks, tabs and line breaks around it.
std::string_view without_blanks(std::string_view field);

/// A decimal number with blanks around it and a leading '+' tolerated. Empty, NaN and infinity are `missing`; what is
/// too small for a double becomes zero. true and false, as pandas, R and others write truth values, are 1 and 0.
ParsedNumber parse_number(std::string_view field);

/// The field in quotes, as messages show it: its first 60 bytes.
std::string shown_field(std::string_view field);

/// A message about a field whose number is `missing` or `out_of_range`.
std::string unusable_number(NumberStatus status, std::string_view field);

}  // namespace modebank
