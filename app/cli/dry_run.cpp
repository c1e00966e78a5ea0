#include "app/cli/dry_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>

#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "app/text/terminal.hpp"
#include "io/import/import.hpp"

namespace modebank::app {
namespace {

std::string origin_of(const Option& option, const Origins& origins) {
  const auto origin = origins.find(option.key);
  return origin == origins.end() ? "default" : origin->second;
}

/// The lines of a key in a configuration. A comment states the origin of each value.
std::string key_lines(const Option& option, const Config& config, const Origins& origins) {
  std::string text;
  std::vector<std::string> values = lines_of(option.get(config));
  if (takes_quotes(option.key)) std::transform(values.begin(), values.end(), values.begin(), path_text);
  const std::vector<std::string> from = lines_of(origin_of(option, origins));
  for (std::size_t i = 0; i < values.size(); ++i)
    text += fmt::format("{:<40}  # {}\n", option.name() + " =" + (values[i].empty() ? "" : " " + values[i]),
                        from[std::min(i, from.size() - 1)]);
  return text;
}

}  // namespace

Result dry_run(const Config& config, const std::vector<std::filesystem::path>& written) {
  std::vector<std::filesystem::path> read;
  if (!config.data.inputs.empty())
    for (const DataFile& file : data_files(config.data)) read.push_back(file.path);
  if (!config.archive.bank.empty()) read.emplace_back(config.archive.bank);
  Result result;
  nlohmann::json reads = nlohmann::json::array(), writes = nlohmann::json::array();
  for (const std::filesystem::path& file : read) {
    result.text += fmt::format("# reads     {}\n", file.string());
    reads.push_back(file.string());
  }
  for (const std::filesystem::path& file : written) {
    const bool exists = std::filesystem::exists(file);
    result.text += fmt::format("# writes    {}{}\n", file.string(), exists ? " (is there)" : "");
    writes.push_back({{"file", file.string()}, {"exists", exists}});
  }
  result.members = {{"reads", reads}, {"writes", writes}};
  return result;
}

void add_values(const Config& config, const Origins& origins, Result& result) {
  nlohmann::json& keys = result.members["keys"];
  std::string section;
  for (const Option& option : option_table()) {
    if (option.section() != section) result.text += fmt::format("\n[{}]\n", option.section());
    section = option.section();
    result.text += key_lines(option, config, origins);
    keys[option.key] = {{"value", option.get(config)},
                        {"origin", boost::replace_all_copy(origin_of(option, origins), "\n", ", ")}};
  }
}

}  // namespace modebank::app
