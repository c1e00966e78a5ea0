#pragma once

#include "ident/data/trajectory.hpp"

namespace modebank {

/// Samples first to first + count - 1 of a run, under its name.
Trajectory stretch(const Trajectory& run, Eigen::Index first, Eigen::Index count);

}  // namespace modebank
