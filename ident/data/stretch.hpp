#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Samples first to first + count - 1 of a run, under its name.
Trajectory stretch(const Trajectory& run, Eigen::Index first, Eigen::Index count);

/// The training runs without their first `earlier` samples, so that models of different memory predict the same
/// samples.
Recording from_common_start(const Recording& recording, Eigen::Index earlier);

}  // namespace modebank
