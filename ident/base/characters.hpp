#pragma once

#include <string>
#include <string_view>

namespace modebank {

// Of ASCII, whatever the locale says.
constexpr bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
constexpr bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
constexpr bool is_letter(char c) { return is_lower(c) || is_upper(c); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// What a terminal would obey.
constexpr bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

/// The letters and digits of a text, a stretch of anything else between them as one '_'.
std::string letters_and_digits(std::string_view text);

}  // namespace modebank
