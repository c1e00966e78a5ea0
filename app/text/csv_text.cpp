#include "app/text/csv_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/files/csv_field.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

/// A number with all digits; an empty field for an unknown number.
std::string field(const json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return csv_field(value.get<std::string>());
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return value.dump();
}

/// Appends the fields of a value, and the names of the fields. Each number of a nested list becomes a field.
void append(const std::string& name, const json& value, std::vector<std::string>* names,
            std::vector<std::string>& fields) {
  if (!value.is_array()) {
    if (names) names->push_back(csv_field(name));
    fields.push_back(field(value));
    return;
  }
  for (std::size_t i = 0; i < value.size(); ++i) append(fmt::format("{}[{}]", name, i), value[i], names, fields);
}

std::string line_of(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) line += (i > 0 ? "," : "") + fields[i];
  return line + "\n";
}

[[noreturn]] void refuse_group(const json& group, const std::string& path) {
  std::string members;
  for (const auto& [name, member] : group.at("members").items()) members += (members.empty() ? "" : ", ") + name;
  throw ConfigurationError(fmt::format("{} is a group, not a table or an array; its members are: {}", path, members));
}

}  // namespace

std::string csv_text(const json& object, const std::string& path) {
  if (!object.contains("value")) refuse_group(object, path);
  const json rows = object["value"].is_array() ? object["value"] : json::array({object["value"]});
  const std::string name = path.substr(path.find_last_of('/') + 1);
  std::vector<std::string> header;
  std::string text;
  for (const json& row : rows) {
    std::vector<std::string> fields;
    std::vector<std::string>* names = header.empty() ? &header : nullptr;
    for (const json& column : object.value("columns", json::array()))
      append(column.get<std::string>(), row.at(column.get<std::string>()), names, fields);
    if (!object.contains("columns")) append(name, row, names, fields);
    text += line_of(fields);
  }
  for (const json& column : rows.empty() ? object.value("columns", json::array()) : json::array())
    header.push_back(csv_field(column.get<std::string>()));
  return line_of(header) + text;
}

}  // namespace modebank::app
