#pragma once

#include <array>
#include <numeric>
#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Numbers of windows by the result of their fit. Used for windows that are not in memory.
struct WindowCounts {
  std::array<Index, 4> status{};  ///< index: FitStatus
  void add(const WindowFits& fits);
  Index of(FitStatus which) const { return status[static_cast<std::size_t>(which)]; }
  Index total() const { return std::accumulate(status.begin(), status.end(), Index{0}); }
};

/// Warning on windows without a finite fit; empty if there are none.
std::string window_warning(const WindowCounts& counts);

/// Warning on the refinement of the bank; empty if it has converged.
std::string refinement_warning(MeasuredFit fit);

/// Warning that no mode of the bank is stable; empty if a mode is stable.
std::string stability_warning(const Bank& bank);

/// Warning that measured samples have no score. The bank's filter starts only when all its lags are known. Empty if at
/// most `least_share` of the samples have no score. The first samples of each run do not count.
std::string unscored_warning(const Archive& archive, double least_share = 0.0);

/// All warnings on an archive's final result. A warning on a mixture that refinement has replaced does not count.
/// `show` prints each warning in its section.
std::vector<std::string> archive_warnings(const Archive& archive);

}  // namespace modebank::app
