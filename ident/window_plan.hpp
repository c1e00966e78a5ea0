#pragma once

#include <vector>

#include "ident/fit_options.hpp"
#include "ident/local_model.hpp"
#include "ident/window.hpp"

namespace modebank {

/// The windows of make_windows by their index, without a list of them.
class WindowPlan {
 public:
  WindowPlan(const Recording& recording, Index length, Index step, Index first);

  Index count() const { return count_; }
  Window window(Index i) const;

  /// Consecutive windows of one run.
  struct Stretch {
    Index first = 0;  ///< index of the first window
    Index count = 0;
    Window window;  ///< the first one
  };
  /// Windows first .. first + count - 1, in stretches of at most `longest`.
  std::vector<Stretch> stretches(Index first, Index count, Index longest) const;

 private:
  std::vector<Stretch> runs_;
  Index step_;
  Index count_ = 0;
};

/// WindowFits without windows: what the options say of all of them. Throws DataError when there are to be none.
WindowFits empty_fits(const FitOptions& options, const LinearStructure& structure, Index windows);

}  // namespace modebank
