#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <nlohmann/json.hpp>

#include "app/cli/commands.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "app/config/path_text.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::vector<std::string> lines_in(const std::string& text) {
  std::vector<std::string> lines;
  boost::split(lines, text, [](char c) { return c == '\n'; });
  return lines;
}

/// The resolved configuration as a valid configuration file. Comments state the origin of each value.
std::string text_with_origins(const Config& config, const Origins& origins) {
  std::string text, section;
  for (const Option& option : option_table()) {
    if (option.section() != section) text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", option.section());
    section = option.section();
    const auto origin = origins.find(option.key);
    std::vector<std::string> values = lines_in(option.get(config));
    if (takes_quotes(option.key)) std::transform(values.begin(), values.end(), values.begin(), path_text);
    const std::vector<std::string> from = lines_in(origin == origins.end() ? "default" : origin->second);
    for (std::size_t i = 0; i < values.size(); ++i)
      text += fmt::format("{:<40}  # {}\n", option.name() + " =" + (values[i].empty() ? "" : " " + values[i]),
                          from[std::min(i, from.size() - 1)]);
  }
  return text;
}

nlohmann::json keys_json(const Config& config, const Origins& origins) {
  nlohmann::json keys = nlohmann::json::object();
  for (const Option& option : option_table()) {
    const auto origin = origins.find(option.key);
    keys[option.key] = {
        {"value", option.get(config)},
        {"origin", origin == origins.end() ? "default" : boost::replace_all_copy(origin->second, "\n", ", ")}};
  }
  return keys;
}

/// A list of alternatives becomes an enumeration. Every other value is a text, as in the configuration file.
nlohmann::ordered_json schema_of(const Option& option) {
  nlohmann::ordered_json schema{{"type", "string"}, {"description", option.help}, {"default", option.get(Config{})}};
  if (const std::vector<std::string> choices = option.choices(); !choices.empty())
    schema["enum"] = choices;
  else
    schema["description"] = fmt::format("{} ({})", option.help, option.range);
  if (!option.unit.empty()) schema["x-unit"] = option.unit;
  schema["x-basic"] = option.basic;
  schema["x-when"] = option.when;
  if (option.stage) schema["x-stage"] = name_of(*option.stage);
  if (!option.repeatable) return schema;
  return {{"oneOf", {schema, {{"type", "array"}, {"items", {{"type", "string"}}}}}}};
}

std::string json_schema() {
  nlohmann::ordered_json sections = nlohmann::ordered_json::object();
  for (const Option& option : option_table()) {
    nlohmann::ordered_json& section = sections[option.section()];
    section["type"] = "object";
    section["additionalProperties"] = false;
    section["properties"][option.name()] = schema_of(option);
  }
  const nlohmann::ordered_json schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                                      {"title", "configuration of modebank"},
                                      {"type", "object"},
                                      {"additionalProperties", false},
                                      {"properties", sections}};
  return schema.dump(2) + "\n";
}

}  // namespace

int run_config(const CommandLine& line) {
  if (line.schema != line.files.empty() || line.files.size() > 1)
    throw ConfigurationError(
        "config needs one configuration file, or --schema alone: modebank config CONFIG, modebank config --schema");
  if (line.schema) {
    fmt::print("{}", json_schema());
    return 0;
  }
  Origins origins;
  const Config config = load_config(line.files.front(), line.overrides, &origins);
  print_text(line, text_with_origins(config, origins));
  print_json(line, {{"keys", keys_json(config, origins)}});
  return 0;
}

}  // namespace modebank::app
