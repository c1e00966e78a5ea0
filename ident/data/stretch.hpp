#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Samples first to first + count - 1 of a run, with the name of the run.
Trajectory stretch(const Trajectory& run, Eigen::Index first, Eigen::Index count);

/// The training runs without their first `earlier` samples. Models with different numbers of lags then predict the same
/// samples.
Recording from_common_start(const Recording& recording, Eigen::Index earlier);

}  // namespace modebank
