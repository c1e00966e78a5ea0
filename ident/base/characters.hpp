#pragma once

#include <string>
#include <string_view>

namespace modebank {

// ASCII only; does not depend on the locale.
constexpr bool is_lower(char c) { return c >= 'a' && c <= 'z'; }
constexpr bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }
constexpr bool is_letter(char c) { return is_lower(c) || is_upper(c); }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
/// Whether a terminal would interpret the character as a control character.
constexpr bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

/// The letters and digits of a text, with '_' in place of each run of other characters.
std::string letters_and_digits(std::string_view text);

}  // namespace modebank
