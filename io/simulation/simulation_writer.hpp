#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"
#include "ident/simulate/simulate_vehicle.hpp"

namespace modebank {

/// Folder and names for simulated runs in the two files that `import` reads.
/// - pro_NN.csv, at the system's rate: time, inputs, truth columns, mode and, if modes have names, ground.
/// - imu_NN.csv, at `state_rate_hz`: time and states. The states are y, interpolated linearly between the system's
/// samples. If `state_rate_hz` is a multiple of the system's rate, the file contains every sample of y exactly.
struct SimulationLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< names of the n columns
  std::vector<std::string> inputs;  ///< names of the m columns
  double state_rate_hz = 65.0;
  std::vector<std::string> grounds = {};  ///< names of the modes; empty: modes have only numbers
};

/// Truth columns are named true_<state>. `mode` counts from 0. Either all files are written or none. Simulated runs of
/// the same names are replaced. Throws ConfigurationError if the folder cannot be created or contains files of other
/// runs.
void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout);

/// Names of the measured columns of a simulated vehicle's files. All other names are fixed.
struct VehicleLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< yaw rate, forward speed and sideways speed, in this order; only the measured
                                    ///< ones
  std::vector<std::string> inputs;  ///< speeds of the left and the right wheel
  std::vector<std::string> grounds = {};  ///< names of the kinds of ground; empty: they have only numbers
};

/// Writes runs of a simulated vehicle as the two files that `import` reads. Either all files are written or none.
/// - pro_NN.csv has the stamps of the wheels' clock. It contains time, wheel speeds, and the set-points as cmd_<input>.
/// - imu_NN.csv has true times. It contains time, the measured states, and the truth, because the stamps in pro_NN.csv
/// may be wrong. The truth is true_<state> of all three states (vx, vy if not measured), true_<input>, x, y, heading,
/// friction (mean of the wheels), mode (ground under the centre, from 0) and, if names are given, ground.
///
/// Throws ConfigurationError if names do not match the runs, or if the folder cannot be created.
void write_simulation(const std::vector<VehicleRun>& runs, const VehicleLayout& layout);

}  // namespace modebank
