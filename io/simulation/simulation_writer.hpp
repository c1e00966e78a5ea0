#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate/simulate.hpp"

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

}  // namespace modebank
