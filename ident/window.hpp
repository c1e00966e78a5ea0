#pragma once

#include <vector>

#include "ident/trajectory.hpp"

namespace modebank {

/// A stretch of `length` consecutive transitions (length + 1 samples) of one run; the length is common to all windows.
struct Window {
  Index run = 0;    ///< position in Recording::runs
  Index start = 0;  ///< first sample
};

/// All windows of the training runs, run by run from transition `first` on, advanced by `step` transitions; none
/// crosses the border of a run. Runs with fewer than `first + length` transitions have no window. Requires length >= 1
/// and step >= 1.
std::vector<Window> make_windows(const Recording& recording, Index length, Index step, Index first = 0);

}  // namespace modebank
