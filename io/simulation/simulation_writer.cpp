#include "io/simulation/simulation_writer.hpp"

#include <fmt/format.h>

#include <cmath>

#include "ident/data/streams.hpp"
#include "io/simulation/simulation_files.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<std::string> inputs_header(const SimulationLayout& layout) {
  std::vector<std::string> names{"time"};
  names.insert(names.end(), layout.inputs.begin(), layout.inputs.end());
  for (const std::string& state : layout.states) names.push_back("true_" + state);
  names.emplace_back("mode");
  if (!layout.grounds.empty()) names.emplace_back("ground");
  return names;
}

std::vector<std::string> states_header(const SimulationLayout& layout) {
  std::vector<std::string> names{"time"};
  names.insert(names.end(), layout.states.begin(), layout.states.end());
  return names;
}

/// The name of the ground of each sample.
std::vector<std::string> names_of_kinds(const Eigen::VectorXi& kinds, const std::vector<std::string>& names) {
  std::vector<std::string> column;
  for (const int kind : kinds) column.push_back(names.at(static_cast<std::size_t>(kind)));
  return column;
}

SimulationTable inputs_table(const SimulatedRun& run, const SimulationLayout& layout) {
  const Trajectory& measured = run.measured;
  SimulationTable table{inputs_header(layout), {}};
  if (!layout.grounds.empty()) table.texts.push_back(names_of_kinds(run.mode, layout.grounds));
  table.values.resize(std::ssize(table.names) - std::ssize(table.texts), measured.samples());
  table.values << measured.time_s.transpose(), measured.input, measured.truth, run.mode.cast<double>().transpose();
  return table;
}

/// The times extend to one period after the end of the run, so that rounding does not remove the last sample.
VectorXd states_times(const VectorXd& time_s, double rate_hz) {
  const double duration_s = time_s(time_s.size() - 1) - time_s(0);
  VectorXd result(static_cast<Index>(std::ceil(duration_s * rate_hz)) + 2);
  for (Index k = 0; k < result.size(); ++k) result(k) = time_s(0) + static_cast<double>(k) / rate_hz;
  return result;
}

SimulationTable states_table(const SimulatedRun& run, const SimulationLayout& layout) {
  const VectorXd time_s = states_times(run.measured.time_s, layout.state_rate_hz);
  SimulationTable table{states_header(layout), {}};
  table.values.resize(static_cast<Index>(table.names.size()), time_s.size());
  table.values << time_s.transpose(), interpolate({run.measured.time_s, run.measured.state}, time_s);
  return table;
}

void check_layout(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout) {
  constexpr double highest_rate_hz = 1e6;
  if (!(layout.state_rate_hz > 0.0 && layout.state_rate_hz <= highest_rate_hz))
    throw ConfigurationError(fmt::format("the rate of the simulated states is {} Hz; it must be above 0 and at most {}",
                                         layout.state_rate_hz, highest_rate_hz));
  check_column_names(inputs_header(layout));
  check_column_names(states_header(layout));
  for (const SimulatedRun& run : runs) {
    const Trajectory& measured = run.measured;
    if (measured.state.rows() != static_cast<Index>(layout.states.size()) ||
        measured.input.rows() != static_cast<Index>(layout.inputs.size()))
      throw ConfigurationError(fmt::format("{} state and {} input names for {} simulated states and {} inputs",
                                           layout.states.size(), layout.inputs.size(), measured.state.rows(),
                                           measured.input.rows()));
    if (measured.samples() < 1) throw ConfigurationError("a simulated run has no sample");
    if (measured.truth.rows() != measured.state.rows() || measured.truth.cols() != measured.samples() ||
        run.mode.size() != measured.samples())
      throw ConfigurationError("a simulated run lacks truth or modes");
  }
}

}  // namespace

void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout) {
  check_layout(runs, layout);
  write_simulation_files(layout.folder, runs.size(), [&](std::size_t i) {
    return SimulationTables{inputs_table(runs[i], layout), states_table(runs[i], layout)};
  });
}

}  // namespace modebank
