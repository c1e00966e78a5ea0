#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// The parts of a run without a gap in time and without dropped samples. `kept`: one value per sample; empty: all
/// samples are kept. Unless `predict`, every state and input in a part is known.
/// Names of parts are RUN.1, RUN.2, ..., or RUN for a whole run. A part of one sample has no transition and is skipped.
/// Throws DataError if no part remains.
std::vector<Trajectory> split_at_gaps(const Trajectory& run, bool predict, const std::vector<bool>& kept = {});

/// Sets a missing input to its last known value, because robots hold a command until the next one. The run starts at
/// the first sample in which all inputs are known. Missing states stay NaN; the filter only predicts them. Throws
/// DataError if fewer than two samples remain.
Trajectory hold_missing_inputs(const Trajectory& run);

}  // namespace modebank
