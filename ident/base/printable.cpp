#include "ident/base/printable.hpp"

namespace modebank {

namespace {

std::string shown(std::string_view text, bool lines) {
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

}  // namespace

std::string printable(std::string_view text) { return shown(text, true); }

std::string printable_name(std::string_view text) { return shown(text, false); }

}  // namespace modebank
