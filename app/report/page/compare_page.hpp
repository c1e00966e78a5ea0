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

inline constexpr std::size_t most_compared = 6;  ///< the page has this many letters and colours for runs

/// The page that compares two or more archives. It states which archive predicts better and lists the different
/// settings. It shows the modes beside the matching modes of the first archive, the scores side by side, and plots of
/// all runs.
Page compare_page(const std::vector<ComparedRun>& runs, const ReportConfig& options);

}  // namespace modebank::app::report
