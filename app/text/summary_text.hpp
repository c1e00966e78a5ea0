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

/// What the summary says of windows: how many, how they ended, the global model, and the batch solver's audit.
/// `labels`: of the parameters.
std::string windows_text(const WindowFits& common, const WindowCounts& counts, const std::vector<std::string>& labels);

/// parameter_labels of the archive's windows; empty without windows.
std::vector<std::string> window_labels(const Archive& archive);

std::string data_text(const Recording& recording);

/// What of the windows needs a look: solutions that the audit replaced, windows without a finite fit.
std::vector<std::string> window_warnings(const WindowFits& fits, const WindowCounts& counts);

/// What of the bank's refinement needs a look; empty where nothing does.
std::string refinement_warning(MeasuredFit fit);

/// Every warning of an archive: of its windows, mixture and bank. `show` prints each where it belongs.
std::vector<std::string> archive_warnings(const Archive& archive);

/// The summary of an archive as people read it: data, windows, mixture, bank, scores and what the bank gains. Lines
/// longer than `width` columns are broken; 0: none.
std::string summary_text(const Archive& archive, int width = 0);

/// Where the archive comes from.
std::string provenance_text(const Archive& archive);

}  // namespace modebank::app
