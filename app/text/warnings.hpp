#pragma once

#include <array>
#include <numeric>
#include <string>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// Windows by how their fits ended, for those that are not in memory.
struct WindowCounts {
  std::array<Index, 4> status{};  ///< by FitStatus
  void add(const WindowFits& fits);
  Index of(FitStatus which) const { return status[static_cast<std::size_t>(which)]; }
  Index total() const { return std::accumulate(status.begin(), status.end(), Index{0}); }
};

/// Subject of a warning: replaced_windows and failed_windows by the batch solver's audit and by fits that are not
/// finite; mixture: its choice, where the bank is made of it; iteration_limit and stalled: the fit with measurement
/// noise; no_stable_mode; unscored: samples that were measured.
enum class WarningKind {
  replaced_windows,
  failed_windows,
  mixture,
  iteration_limit,
  stalled,
  no_stable_mode,
  unscored
};

struct Warning {
  WarningKind kind;
  std::string text;
};

/// What of the windows needs a look: solutions that the audit replaced, windows without a finite fit.
std::vector<Warning> window_warnings(const WindowFits& fits, const WindowCounts& counts);

/// What of the bank's refinement needs a look; empty where nothing does.
std::string refinement_warning(MeasuredFit fit);

/// That no mode of the bank is stable; empty where one is.
std::string stability_warning(const Bank& bank);

/// That the bank's filter said nothing of samples that were measured, for it starts where the samples that its lags
/// need are whole; empty where it did, or for a smaller share of them. Those that every run starts with are not meant.
std::string unscored_warning(const Archive& archive, double least_share = 0.0);

/// Every warning of an archive about what its result rests on: a mixture that refinement replaced is not that. `show`
/// prints each where it belongs.
std::vector<Warning> archive_warnings(const Archive& archive);

}  // namespace modebank::app
