#pragma once

#include <cstdlib>
#include <string>

namespace modebank::app {

/// A field as RFC 4180 has it: in quotes where it holds a comma, a quote or a line break. What a spreadsheet would take
/// for a formula (it begins with = + - @ and is no number) has an apostrophe in front.
inline std::string csv_field(const std::string& given) {
  const auto is_number = [](const std::string& text) {
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return end == text.c_str() + text.size();
  };
  const bool formula = !given.empty() && std::string("=+-@").find(given.front()) != std::string::npos;
  const std::string text = formula && !is_number(given) ? "'" + given : given;
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace modebank::app
