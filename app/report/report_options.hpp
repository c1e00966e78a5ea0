#pragma once

#include <vector>

#include "app/option_table.hpp"

namespace modebank::app {

/// The [report] section.
std::vector<Option> report_options();

}  // namespace modebank::app
