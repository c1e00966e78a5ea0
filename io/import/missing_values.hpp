#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// The parts of a run without a gap in time and without dropped samples. `kept`: per sample, or empty for all. Unless
/// `predict`, every state and input in a part is known. Names: RUN.1, RUN.2, ..., or RUN for a whole run. A part of one
/// sample has no transition and is left out. Throws DataError if no part remains.
std::vector<Trajectory> split_at_gaps(const Trajectory& run, bool predict, const std::vector<bool>& kept = {});

/// A missing input takes its last known value, as a held command does. The run starts at the first sample with all
/// inputs known. Missing states stay NaN, and the filter only predicts there. Throws DataError if fewer than two
/// samples remain.
Trajectory hold_missing_inputs(const Trajectory& run);

}  // namespace modebank
