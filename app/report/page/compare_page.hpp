#pragma once

#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// One of the compared runs.
struct ComparedRun {
  const Archive& archive;
  std::string name;
};

inline constexpr std::size_t most_compared = 6;  ///< there are this many letters and colours for runs

/// The page that compares two or more archives. It shows the better predictor, different settings, modes matched with
/// those of the first archive, scores side by side, and plots in one figure.
Page compare_page(const std::vector<ComparedRun>& runs, const ReportConfig& options);

}  // namespace modebank::app::report
