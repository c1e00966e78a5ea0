#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"
#include "ident/simulate/simulate_vehicle.hpp"

namespace modebank {

/// Writes simulated runs in the two-file layout that `import` reads.
/// - pro_NN.csv, at the system's rate: time, inputs, truth columns, mode and, if modes have names, ground.
/// - imu_NN.csv, at `state_rate_hz`: time and states. The states are y at the system's own samples, and linear
///   interpolation between these samples. If the rate is a multiple of the system's rate, y is contained exactly.
struct SimulationLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< column names, n
  std::vector<std::string> inputs;  ///< column names, m
  double state_rate_hz = 65.0;
  std::vector<std::string> grounds = {};  ///< names of the modes; empty: modes have only numbers
};

/// Truth columns have names true_<state>; `mode` counts from 0. Either all files are written or none; simulated runs of
/// the same names are replaced. Throws ConfigurationError if the folder cannot be created or has files of other runs.
void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout);

/// Names of a simulated vehicle's measured columns; other names are fixed.
struct VehicleLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< the measured ones of yaw rate, forward speed and sideways speed, in this order
  std::vector<std::string> inputs;  ///< left and right wheel speed
  std::vector<std::string> grounds = {};  ///< names of the kinds of ground; empty: only numbers
};

/// Writes simulated vehicle runs as the two files that `import` reads. Either all files are written or none.
/// - pro_NN.csv has the stamps of the wheels' clock: time, wheel speeds, and the set-points as cmd_<input>.
/// - imu_NN.csv has true time: time, the measured states, and the truth. The truth is here because the stamps of the
///   inputs may be wrong. It contains true_<state> of all three states (vx, vy if not measured), true_<input>, x, y,
///   heading, friction (mean of the wheels), mode (ground under the centre, from 0) and, with names, ground.
///
/// Throws ConfigurationError if names do not fit or the folder cannot be created.
void write_simulation(const std::vector<VehicleRun>& runs, const VehicleLayout& layout);

}  // namespace modebank
