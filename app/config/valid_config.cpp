#include "app/config/valid_config.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>

#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using Options = std::vector<const Option*>;

bool fits(const Config& config) {
  try {
    validate(config);
    return true;
  } catch (const ConfigurationError&) {
    return false;
  }
}

/// The default of a key. The defaults of lags and of the windows' length depend on the model.
std::string standard_of(const Option& option, const Config& config) {
  Config standard;
  if (option.key != "window.model") standard.structure.automatic_model = config.structure.automatic_model;
  return option.get(standard);
}

/// Keys that the file sets to a value other than the default. Keys that the command line overrides are excluded.
Options set_by_file(const Config& config, const Origins& origins) {
  Options options;
  for (const Option& option : option_table()) {
    const auto origin = origins.find(option.key);
    if (origin == origins.end() || origin->second.starts_with("--")) continue;
    if (option.section() != "data" && option.get(config) != standard_of(option, config)) options.push_back(&option);
  }
  return options;
}

/// The smallest set of at most three options that must return to their defaults so that the configuration is valid.
/// Empty if there is none.
Options fewest_to_reset(const Config& config, const Options& options, std::size_t first, std::size_t most) {
  for (std::size_t i = first; most > 0 && i < options.size(); ++i) {
    Config changed = config;
    options[i]->set(changed, standard_of(*options[i], config));
    if (fits(changed)) return {options[i]};
  }
  Options fewest;
  for (std::size_t i = first; most > 1 && i < options.size(); ++i) {
    Config changed = config;
    options[i]->set(changed, standard_of(*options[i], config));
    Options rest = fewest_to_reset(changed, options, i + 1, fewest.empty() ? most - 1 : fewest.size() - 2);
    if (rest.empty()) continue;
    fewest = std::move(rest);
    fewest.insert(fewest.begin(), options[i]);
  }
  return fewest;
}

/// Advice such as "; set --window.state_lags 1, too, because robot.ini:12 has 3". Empty without overrides, or if no
/// advice helps.
std::string what_to_set_too(const Config& config, const KeyValues& overrides, const Origins& origins) {
  constexpr std::size_t most = 3;
  if (overrides.empty()) return "";
  std::vector<std::string> settings, reasons;
  for (const Option* option : fewest_to_reset(config, set_by_file(config, origins), 0, most)) {
    const std::string standard = standard_of(*option, config);
    settings.push_back(fmt::format("--{} {}", option->key, standard.empty() ? "''" : standard));
    reasons.push_back(fmt::format("{} has {}", origins.at(option->key), option->get(config)));
  }
  if (settings.empty()) return "";
  return fmt::format("; set {}, too, because {}", boost::join(settings, " "), boost::join(reasons, ", "));
}

}  // namespace

Config load_valid_config(const std::filesystem::path& path, const KeyValues& overrides) {
  Origins origins;
  Config config = load_config(path, overrides, &origins);
  try {
    validate(config);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(error.what() + what_to_set_too(config, overrides, origins));
  }
  return config;
}

}  // namespace modebank::app
