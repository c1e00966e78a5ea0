#pragma once

#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// One of the runs that are compared.
struct ComparedRun {
  const Archive& archive;
  std::string name;
};

inline constexpr std::size_t most_compared = 6;  ///< more have no letters and colours of their own

/// The page that shows two or more archives together: which predicts better, how their configurations differ, their
/// modes matched with those of the first, their scores side by side, their plots one over the other.
Page compare_page(const std::vector<ComparedRun>& runs, const ReportConfig& options);

}  // namespace modebank::app::report
