#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"
#include "ident/simulate/simulate_vehicle.hpp"

namespace modebank {

/// Writes simulated runs in the two-file layout that `import` reads: pro_NN.csv (time, inputs, truth columns, mode) at
/// the system's rate and imu_NN.csv (time, states) at `state_rate_hz`. The states file holds y at the system's own
/// samples and linear interpolation between them, so a rate that is a multiple of the system's gives y back exactly.
struct SimulationLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< column names, n
  std::vector<std::string> inputs;  ///< column names, m
  double state_rate_hz = 65.0;
};

/// Truth columns are named true_<state>; `mode` counts from 0. All files or none; simulated runs of the same names
/// are replaced. Throws ConfigurationError when the folder cannot be made or holds other runs' files.
void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout);

/// Names of the measured columns of a simulated vehicle; all others are fixed.
struct VehicleLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< yaw rate, then forward speed, then sideways speed: those that are measured
  std::vector<std::string> inputs;  ///< left and right wheel speed
  std::vector<std::string> grounds = {};  ///< names of the kinds of ground; empty: they are numbered alone
};

/// Writes simulated vehicle runs in the two-file layout that `import` reads. pro_NN.csv, at the stamps of the wheels'
/// clock: time, the wheel speeds, their set-points as cmd_<input>. imu_NN.csv, at true time: time, the measured states,
/// and the truth: true_<state> of all three states (those not measured are called vx, vy), true_<input>, x, y, heading,
/// friction (mean of the wheels), mode (ground under the centre, from 0) and, where it has a name, ground. Truth stands
/// beside the states because the inputs' stamps may be wrong. All files or none. Throws ConfigurationError when names
/// do not fit or the folder cannot be made.
void write_simulation(const std::vector<VehicleRun>& runs, const VehicleLayout& layout);

}  // namespace modebank
