#pragma once

#include "ident/data/trajectory.hpp"
#include "modebank/base/recording.hpp"

namespace modebank {

/// Converts a run of n states and m inputs from the public API's type. Throws std::invalid_argument with the run's name
/// if its sizes do not fit or its times do not increase.
Trajectory to_trajectory(const RecordedRun& run, Index states, Index inputs);

/// Converts all runs in order. Throws the errors of to_trajectory. Also throws std::invalid_argument if the number of
/// names differs from the number of signals.
Recording to_recording(const RecordedRuns& runs);

}  // namespace modebank
