#include "app/cli/json_line.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "ident/base/utf8.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

/// Replaces NaN and infinities outside strings by null.
std::string without_bare_nan(std::string_view line) {
  std::string result;
  bool quoted = false;
  for (std::size_t k = 0; k < line.size();) {
    const std::string_view rest = line.substr(k);
    std::size_t word = 0;
    for (const std::string_view name : {"NaN", "nan", "-Infinity", "Infinity"})
      if (word == 0 && !quoted && rest.starts_with(name)) word = name.size();
    if (word > 0) {
      result += "null";
      k += word;
      continue;
    }
    if (line[k] == '"') quoted = !quoted;
    if (quoted && line[k] == '\\' && k + 1 < line.size()) result += line[k++];  // the next character is escaped
    result += line[k++];
  }
  return result;
}

}  // namespace

nlohmann::json parse_json_line(std::string_view line) {
  std::string storage;
  line = utf8_or_windows_1252(line, storage);
  nlohmann::json object = nlohmann::json::parse(line, nullptr, false);
  return object.is_discarded() ? nlohmann::json::parse(without_bare_nan(line), nullptr, false) : object;
}

std::string json_field(const nlohmann::json& object, const std::string& name) {
  const auto member = object.find(name);
  if (member == object.end() || member->is_null()) return {};
  if (member->is_number()) return member->dump();
  if (member->is_boolean()) return member->get<bool>() ? "1" : "0";
  if (member->is_string()) return member->get<std::string>();
  throw DataError(fmt::format("{} is not a number", name));
}

}  // namespace modebank::app
