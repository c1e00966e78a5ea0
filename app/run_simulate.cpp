#include <fmt/format.h>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "ident/error.hpp"
#include "ident/simulate.hpp"
#include "io/simulation_writer.hpp"

namespace modebank::app {
namespace {

/// The system's sizes follow from the columns' names and from the length of a mode's parameters.
SimulationOptions system_of(const Config& config) {
  SimulationOptions system = config.simulate.system;
  system.states = static_cast<Index>(config.data.state.size());
  system.inputs = static_cast<Index>(config.data.input.size());
  system.dt_s = 1.0 / config.simulate.rate_hz;
  if (system.states == 0) throw ConfigurationError("data.state is empty: simulate takes the states' names from it");
  if (system.modes.empty()) throw ConfigurationError("simulate.modes is empty: give the parameters of each mode");
  const Index p = system.modes.front().size();
  system.intercept = p == system.states * (system.states + system.inputs + 1);
  return system;
}

}  // namespace

int run_simulate(const CommandLine& line) {
  if (line.files.size() != 1)
    throw ConfigurationError("simulate needs one configuration file: modebank simulate CONFIG");
  const Config config = load_config(line.files.front(), line.overrides);
  const SimulationLayout layout{config.simulate.output, config.data.state, config.data.input,
                                config.simulate.state_rate_hz};
  const std::vector<SimulatedRun> runs = simulate(system_of(config), config.job.seed);
  write_simulation(runs, layout);
  fmt::print("{} runs of {} samples in {}\n", runs.size(), config.simulate.system.samples, config.simulate.output);
  return 0;
}

}  // namespace modebank::app
