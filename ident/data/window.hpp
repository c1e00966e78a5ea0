#pragma once

#include <vector>

#include "ident/data/trajectory.hpp"

namespace modebank {

/// `length` consecutive transitions (length + 1 samples) of one run. All windows have the same length.
struct Window {
  Index run = 0;    ///< position of the run in Recording::runs
  Index start = 0;  ///< first sample
};

/// All windows of the training runs by index, without a stored list. Windows start at transition `first` of each run
/// and advance by `step`. No window crosses the border of a run. Runs with fewer than `first + length` transitions have
/// no window. Only this class defines the positions of windows.
class WindowPlan {
 public:
  /// Throws std::invalid_argument unless length >= 1 and step >= 1.
  WindowPlan(const Recording& recording, Index length, Index step, Index first = 0);

  Index count() const { return count_; }
  Window window(Index i) const;

  /// Consecutive windows of one run.
  struct Range {
    Index first = 0;  ///< index of the first window
    Index count = 0;
    Window window;  ///< first window of the range
  };
  /// Windows first .. first + count - 1, divided into ranges of at most `longest` windows.
  std::vector<Range> ranges(Index first, Index count, Index longest) const;

 private:
  std::vector<Range> runs_;
  Index step_;
  Index count_ = 0;
};

}  // namespace modebank
