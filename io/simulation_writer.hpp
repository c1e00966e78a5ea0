#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/simulate.hpp"

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

/// Truth columns are named true_<state>; `mode` counts from 0. All files or none; existing ones of the same names are
/// replaced. Throws ConfigurationError when the folder cannot be made or holds other runs' files.
void write_simulation(const std::vector<SimulatedRun>& runs, const SimulationLayout& layout);

}  // namespace modebank
