#pragma once

#include <stdexcept>
#include <string>

#include "ident/simulate/simulate.hpp"

namespace modebank::bench {

/// Runs of a system with three modes similar to ice; all are training runs.
inline Recording make_recording(Index runs, Index samples) {
  SimulationOptions options;
  options.modes = {Eigen::Vector3d(-0.60, -0.72, 0.72), Eigen::Vector3d(-0.30, -0.21, 0.21),
                   Eigen::Vector3d(-0.05, -0.02, 0.02)};
  options.process_sd = {0.010, 0.020, 0.006};
  options.measurement_sd = 0.001;
  options.dwell_samples = 150.0;
  options.input_law = InputLaw::white;
  options.runs = runs;
  options.samples = samples;
  Recording recording;
  recording.states = {{"wz", "rad/s"}};
  recording.inputs = {{"left", "m/s"}, {"right", "m/s"}};
  for (SimulatedRun& run : simulate(options, 1)) recording.runs.push_back(std::move(run.measured));
  for (Trajectory& run : recording.runs) run.role = Role::train;
  return recording;
}

/// Stops the benchmark if its result is wrong.
inline void check(bool condition, const std::string& what) {
  if (!condition) throw std::logic_error("benchmark result is wrong: " + what);
}

}  // namespace modebank::bench
