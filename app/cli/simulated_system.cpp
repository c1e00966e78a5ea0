#include "app/cli/simulated_system.hpp"

#include <fmt/format.h>

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "app/config/options/sections.hpp"
#include "app/report/page/assets.hpp"
#include "ident/base/nearest_name.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

struct SystemText {
  std::string text, name;  ///< and how messages call it
};

SystemText system_text(const std::string& system, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / system;
  if (std::filesystem::is_regular_file(file)) return {read_file(file), file.string()};
  if (system == "husky_ice") return {std::string(assets::husky_ice_system()), system};
  if (system == "three_grips") return {std::string(assets::three_grips_system()), system};
  throw ConfigurationError(
      fmt::format("simulate.system = {}: expected husky_ice, three_grips or a file, and there is none at {}", system,
                  file.string()));
}

const Option& parameter(const std::string& where, const std::string& key) {
  if (const Option* const found = find_option(system_parameters(), key)) return *found;
  std::vector<std::string> keys;
  for (const Option& option : system_parameters()) keys.push_back(option.key);
  throw ConfigurationError(fmt::format("{}: unknown key {}{}", where, key, did_you_mean(key, keys)));
}

}  // namespace

void read_system(const std::filesystem::path& folder, Config& config) {
  const SystemText system = system_text(config.simulate.name, folder);
  std::set<std::string> seen;
  std::vector<std::pair<const Option*, std::string>> of_one_kind;
  for (const FileEntry& entry : parse_lines(system.text, system.name)) {
    const std::string where = fmt::format("{}:{}", system.name, entry.line);
    const Option& option = parameter(where, entry.key);
    if (!seen.insert(entry.key).second) throw ConfigurationError(fmt::format("{}: {} is set twice", where, entry.key));
    set_option(config, option, where, entry.value, entry.has_comment);
    if (option.only_for) of_one_kind.emplace_back(&option, where);
  }
  if (!seen.contains("system.kind"))
    throw ConfigurationError(system.name + ": system.kind is not set: linear or vehicle");
  for (const auto& [option, where] : of_one_kind)
    if (*option->only_for != config.simulate.kind)
      throw ConfigurationError(fmt::format("{}: {} belongs to system.kind = {}, but the system is {}", where,
                                           option->key, name_of(*option->only_for), name_of(config.simulate.kind)));
}

}  // namespace modebank::app
