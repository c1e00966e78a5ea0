#include "app/cli/simulated_system.hpp"

#include <fmt/format.h>

#include <map>
#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/config/faults.hpp"
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
  std::string text, name;  ///< name: the parameter's name in messages
};

SystemText system_text(const std::string& system, const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / system;
  if (std::filesystem::is_regular_file(file)) return {read_file(file), file.string()};
  if (system == "three_grips") return {std::string(assets::three_grips_system()), system};
  if (system == "two_grounds") return {std::string(assets::two_grounds_system()), system};
  throw ConfigurationError(
      fmt::format("simulate.system = {}: expected three_grips, two_grounds or a file, and there is none at {}", system,
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
  std::map<std::string, std::string> seen;
  Faults faults;
  for (const FileEntry& entry : parse_lines(system.text, system.name, faults))
    faults.collect([&] {
      const std::string where = fmt::format("{}:{}", system.name, entry.line);
      const Option& option = parameter(where, entry.key);
      if (!seen.emplace(entry.key, where).second)
        throw ConfigurationError(fmt::format("{}: {} is set twice", where, entry.key));
      set_option(config, option, where, entry.value, entry.has_comment);
    });
  faults.refuse();
}

}  // namespace modebank::app
