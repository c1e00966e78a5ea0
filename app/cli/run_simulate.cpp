#include <fmt/format.h>
#include <tbb/global_control.h>

#include <map>

#include "app/cli/commands.hpp"
#include "app/cli/dry_run.hpp"
#include "app/config/config_file.hpp"
#include "app/config/faults.hpp"
#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "app/config/options/sections.hpp"
#include "app/report/page/assets.hpp"
#include "ident/base/nearest_name.hpp"
#include "io/files/read_file.hpp"
#include "io/simulation/simulation_writer.hpp"
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

/// The system's sizes follow from the names of the columns and from the number of parameters of a mode.
SimulationOptions system_of(const Config& config) {
  SimulationOptions system = config.simulate.system;
  system.states = static_cast<Index>(config.data.state.size());
  system.inputs = static_cast<Index>(config.data.input.size());
  system.dt_s = 1.0 / config.simulate.rate_hz;
  if (system.states == 0)
    throw ConfigurationError(
        "data.state is empty; simulate takes the names of the states from it, for example data.state = wz");
  if (system.modes.empty())
    throw ConfigurationError(config.simulate.name + ": system.modes is empty; give the parameters of each mode");
  const Index p = system.modes.front().size();
  system.intercept = p == system.states * (system.states + system.inputs + 1);
  return system;
}

/// One name per mode, or an empty list.
const std::vector<std::string>& grounds_of(const SimulateConfig& options) {
  if (!options.ground_names.empty() && options.ground_names.size() != options.system.modes.size())
    throw ConfigurationError(fmt::format("system.ground_names has {} names for {} modes (system.modes)",
                                         options.ground_names.size(), options.system.modes.size()));
  return options.ground_names;
}

void simulate_system(const Config& config) {
  const DataOptions& data = config.data;
  const SimulateConfig& options = config.simulate;
  write_simulation(simulate(system_of(config), config.job.seed),
                   {options.output, data.state, data.input, options.state_rate_hz, grounds_of(options)});
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

Result do_simulate(const CommandLine& line) {
  Config config = load_config(line.files.front(), line.overrides);
  read_system(std::filesystem::absolute(line.files.front()).parent_path(), config);
  if (line.dry_run) return dry_run({}, {config.simulate.output});
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  simulate_system(config);
  const SimulationOptions& made = config.simulate.system;
  return {fmt::format("{} runs of {} samples in {}\n", made.runs, made.samples, config.simulate.output),
          {{"written", {config.simulate.output}}, {"runs", made.runs}, {"samples", made.samples}}};
}

int run_simulate(const CommandLine& line) { return print_result(line, do_simulate(line)); }

}  // namespace modebank::app
