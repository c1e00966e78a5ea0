#pragma once

#include <string>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

/// The page of one archive: configuration, verdict, data, local models, selection, bank, filter. The page states which
/// of these parts the archive does not have. `file`: name of the archive, for the title.
Page run_page(const Archive& archive, const std::string& file, const ReportConfig& options);

}  // namespace modebank::app::report
