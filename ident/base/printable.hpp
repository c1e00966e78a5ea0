#pragma once

#include <string>
#include <string_view>

#include "ident/base/characters.hpp"

namespace modebank {

/// The text as a terminal may be given it: control characters but line ends as \x1b.
inline std::string printable(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string result;
  for (const char c : text) {
    if (!is_control(c) || c == '\n') {
      result += c;
      continue;
    }
    const auto code = static_cast<unsigned char>(c);
    result += {'\\', 'x', digits[code / 16], digits[code % 16]};
  }
  return result;
}

}  // namespace modebank
