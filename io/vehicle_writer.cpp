#include "io/vehicle_writer.hpp"

#include <fmt/format.h>

#include "ident/error.hpp"
#include "io/simulation_files.hpp"

namespace modebank {

namespace {

using HeaderNames = std::vector<std::string>;

HeaderNames vehicle_inputs_header(const VehicleLayout& layout) {
  HeaderNames names{"time"};
  for (const std::string& input : layout.inputs) names.push_back(input);
  for (const std::string& input : layout.inputs) names.push_back("cmd_" + input);
  return names;
}

HeaderNames vehicle_states_header(const VehicleLayout& layout) {
  const HeaderNames usual{"wz", "vx", "vy"};
  HeaderNames names{"time"};
  names.insert(names.end(), layout.states.begin(), layout.states.end());
  for (std::size_t i = 0; i < usual.size(); ++i)
    names.push_back("true_" + (i < layout.states.size() ? layout.states[i] : usual[i]));
  for (const std::string& input : layout.inputs) names.push_back("true_" + input);
  for (const char* name : {"x", "y", "heading", "friction", "mode"}) names.emplace_back(name);
  return names;
}

SimulationTables vehicle_tables(const VehicleRun& run, const VehicleLayout& layout) {
  SimulationTables tables{{vehicle_inputs_header(layout), {}}, {vehicle_states_header(layout), {}}};
  tables.inputs.values.resize(static_cast<Index>(tables.inputs.names.size()), run.inputs_time_s.size());
  tables.inputs.values << run.inputs_time_s.transpose(), run.wheel_speed, run.command;
  tables.states.values.resize(static_cast<Index>(tables.states.names.size()), run.time_s.size());
  tables.states.values << run.time_s.transpose(), run.measured, run.truth, run.true_wheel, run.pose,
      run.friction.transpose(), run.kind.cast<double>().transpose();
  return tables;
}

}  // namespace

void write_simulation(const std::vector<VehicleRun>& runs, const VehicleLayout& layout) {
  if (layout.inputs.size() != 2 || layout.states.empty() || layout.states.size() > 3)
    throw ConfigurationError(fmt::format(
        "{} state and {} input names for a simulated vehicle: it has 1 to 3 states (yaw rate, forward speed, "
        "sideways speed) and 2 inputs (left and right wheel speed)",
        layout.states.size(), layout.inputs.size()));
  check_column_names(vehicle_inputs_header(layout));
  check_column_names(vehicle_states_header(layout));
  for (const VehicleRun& run : runs)
    if (run.measured.rows() != static_cast<Index>(layout.states.size()))
      throw ConfigurationError(
          fmt::format("{} state names for {} simulated states", layout.states.size(), run.measured.rows()));
  write_simulation_files(layout.folder, runs.size(), [&](std::size_t i) { return vehicle_tables(runs[i], layout); });
}

}  // namespace modebank
