#pragma once

#include "ident/data/trajectory.hpp"
#include "modebank/base/recording.hpp"

namespace modebank {

/// A run as programs hand it over, of n states and m inputs, in our own form. Throws std::invalid_argument naming the
/// run when its sizes do not fit or its times do not increase.
Trajectory to_trajectory(const RecordedRun& run, Index states, Index inputs);

/// All runs, in their order. Throws as to_trajectory does, and for names that are not as many as the first run has
/// signals.
Recording to_recording(const RecordedRuns& runs);

}  // namespace modebank
