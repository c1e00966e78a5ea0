#include "ident/base/characters.hpp"

namespace modebank {

std::string printable(std::string_view text, bool lines) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  const auto add = [&](unsigned char c) {
    result += "\\x";
    result += digits[c / 16];
    result += digits[c % 16];
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    // U+0080 .. U+009F, which terminals obey as well, are two bytes of UTF-8.
    const bool second_set =
        c == '\xc2' && i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xe0) == 0x80;
    if (second_set)
      add(static_cast<unsigned char>(text[++i]));
    else if (is_control(c) && !(lines && (c == '\n' || c == '\t')))
      add(static_cast<unsigned char>(c));
    else
      result += c;
  }
  return result;
}

std::string letters_and_digits(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (is_letter(c) || is_digit(c))
      result += c;
    else if (!result.empty() && result.back() != '_')
      result += '_';
  }
  if (!result.empty() && result.back() == '_') result.pop_back();
  return result;
}

}  // namespace modebank
