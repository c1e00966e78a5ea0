#pragma once

#include <string>
#include <string_view>

namespace modebank {

enum class NumberStatus { ok, missing, out_of_range, text };

struct ParsedNumber {
  double value = 0.0;
  NumberStatus status = NumberStatus::ok;
};

/// The field without blanks, tabs and line breaks around it.
std::string_view without_blanks(std::string_view field);

/// A decimal number. Blanks around the number and a leading '+' are allowed. Empty, NaN and infinity are `missing`; a
/// number too small for a double is zero. true and false, as pandas, R and others write them, are 1 and 0.
ParsedNumber parse_number(std::string_view field);

/// The field in quotes for messages: its first 60 bytes.
std::string shown_field(std::string_view field);

/// Text for a message on a field whose number is `missing` or `out_of_range`.
std::string unusable_number(NumberStatus status, std::string_view field);

}  // namespace modebank
