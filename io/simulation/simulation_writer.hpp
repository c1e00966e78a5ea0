#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate_vehicle.hpp"

namespace modebank {

/// Names of the measured columns of a simulated vehicle; all others are fixed.
struct VehicleLayout {
  std::filesystem::path folder;     ///< created if its parent exists
  std::vector<std::string> states;  ///< yaw rate, then forward speed, then sideways speed: those that are measured
  std::vector<std::string> inputs;  ///< left and right wheel speed
};

/// Writes simulated vehicle runs in the two-file layout that `import` reads. pro_NN.csv, at the stamps of the wheels'
/// clock: time, the wheel speeds, their set-points as cmd_<input>. imu_NN.csv, at true time: time, the measured states,
/// and the truth: true_<state> of all three states (those not measured are called vx, vy), true_<input>, x, y, heading,
/// friction (mean of the wheels) and mode (ground under the centre, from 0). Truth stands beside the states because the
/// inputs' stamps may be wrong. All files or none. Throws ConfigurationError when names do not fit or the folder cannot
/// be made.
void write_simulation(const std::vector<VehicleRun>& runs, const VehicleLayout& layout);

}  // namespace modebank
