#pragma once

#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// The stretches of a run without a gap in time, whose samples are all kept (`kept`: per sample, or empty for all) and,
/// unless `predict`, in which every state and input is known; named RUN.1, RUN.2, ... (RUN itself when it is whole). A
/// stretch of one sample holds no transition and is left out. Throws DataError when none is left.
std::vector<Trajectory> split_at_gaps(const Trajectory& run, bool predict, const std::vector<bool>& kept = {});

/// Inputs that miss keep their last known value, as a command does; the run starts where every input is known. States
/// stay NaN: the filter only predicts there. Throws DataError when fewer than two samples are left.
Trajectory hold_missing_inputs(const Trajectory& run);

}  // namespace modebank
