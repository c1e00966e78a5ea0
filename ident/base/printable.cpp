#include "ident/base/printable.hpp"

#include <algorithm>

#include "ident/base/utf8.hpp"

namespace modebank {

namespace {

/// U+2028 .. U+202E and U+2066 .. U+2069, three bytes of UTF-8 each. They break or reorder a displayed line.
const char* misleading(std::string_view text) {
  constexpr std::string_view first_bytes = "\xe2\x80", second_bytes = "\xe2\x81";
  constexpr const char* first[]{"\\u2028", "\\u2029", "\\u202a", "\\u202b", "\\u202c", "\\u202d", "\\u202e"};
  constexpr const char* second[]{"\\u2066", "\\u2067", "\\u2068", "\\u2069"};
  if (text.size() < 3) return nullptr;
  const auto last = static_cast<unsigned char>(text[2]);
  if (text.starts_with(first_bytes) && last >= 0xa8 && last <= 0xae) return first[last - 0xa8];
  if (text.starts_with(second_bytes) && last >= 0xa6 && last <= 0xa9) return second[last - 0xa6];
  return nullptr;
}

enum class Bytes { as_they_are, utf8_alone };

std::string shown(std::string_view text, bool lines, Bytes bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  const auto add = [&](unsigned char c) {
    result += "\\x";
    result += digits[c / 16];
    result += digits[c % 16];
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    // U+0080 .. U+009F are two bytes of UTF-8. Terminals interpret these characters as control characters.
    const bool second_set =
        c == '\xc2' && i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xe0) == 0x80;
    if (const char* const escaped = misleading(text.substr(i))) {
      result += escaped;
      i += 2;
    } else if (second_set) {
      add(static_cast<unsigned char>(text[++i]));
    } else {
      const bool escapes = is_control(c) && !(lines && (c == '\n' || c == '\t'));
      const std::size_t count = escapes ? 0 : bytes == Bytes::as_they_are ? 1 : character_bytes(text.substr(i));
      if (count == 0) add(static_cast<unsigned char>(c));
      result += text.substr(i, count);
      i += std::max<std::size_t>(count, 1) - 1;
    }
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return shown(text, true, Bytes::utf8_alone); }

std::string printable_name(std::string_view text) { return shown(text, false, Bytes::utf8_alone); }

bool holds_controls(std::string_view text) { return shown(text, true, Bytes::as_they_are) != text; }

bool name_holds_controls(std::string_view text) { return shown(text, false, Bytes::as_they_are) != text; }

}  // namespace modebank
