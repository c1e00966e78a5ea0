#pragma once

#include <vector>

#include "ident/trajectory.hpp"

namespace modebank {

/// The stretches of a run in which every state and input is known, named RUN.1, RUN.2, ... (RUN itself when there is no
/// gap). A stretch of one sample holds no transition and is left out. Throws DataError when none is left.
std::vector<Trajectory> split_at_gaps(const Trajectory& run);

/// Inputs that miss keep their last known value, as a command does; the run starts where every input is known. States
/// stay NaN: the filter only predicts there. Throws DataError when fewer than two samples are left.
Trajectory hold_missing_inputs(const Trajectory& run);

}  // namespace modebank
