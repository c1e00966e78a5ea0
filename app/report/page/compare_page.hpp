#pragma once

#include <array>
#include <string>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// One of the runs that are compared.
struct ComparedRun {
  const Archive& archive;
  std::string name;
};

/// The page that shows two archives together: how their configurations differ, their scores side by side, their plots
/// one over the other.
Page compare_page(const std::array<ComparedRun, 2>& runs, const ReportConfig& options);

}  // namespace modebank::app::report
