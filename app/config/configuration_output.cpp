#include "app/config/configuration_output.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

bool is_configuration(const std::filesystem::path& path) {
  constexpr std::uintmax_t largest = 1 << 22;
  if (std::filesystem::file_size(path) > largest) return false;
  const std::string text = read_file(path);
  try {
    const std::map<std::string, std::string> values = resolved_values(text);
    return std::any_of(values.begin(), values.end(), [](const auto& value) { return find_option(value.first); });
  } catch (const ConfigurationError&) {
    return ("\n" + text).find("\n[data]") != std::string::npos;  // broken, but no log
  }
}

void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force) {
  check_output({option, path, {"a configuration", is_configuration}}, sources);
  if (!force && std::filesystem::exists(path))
    throw ConfigurationError(
        fmt::format("{} exists: name another file (-o FILE), or overwrite it with --force", path.string()));
}

}  // namespace modebank::app
