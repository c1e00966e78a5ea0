#pragma once

#include <string>
#include <string_view>

namespace modebank {

enum class NumberStatus { ok, missing, out_of_range, text };

struct ParsedNumber {
  double value = 0.0;
  NumberStatus status = NumberStatus::ok;
};

/// The field without blanks, tabs and line breaks at its ends.
std::string_view without_blanks(std::string_view field);

/// Parses a decimal number. Blanks around the number and a leading '+' are allowed. Empty fields, NaN and infinity are
/// `missing`. A number too small for a double becomes zero. true and false, which pandas, R and others write, become 1
/// and 0.
ParsedNumber parse_number(std::string_view field);

/// The first 60 bytes of the field in quotes, for messages.
std::string shown_field(std::string_view field);

/// Text for a message about a field whose number is `missing` or `out_of_range`.
std::string unusable_number(NumberStatus status, std::string_view field);

}  // namespace modebank
