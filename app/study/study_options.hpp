#pragma once

#include <vector>

#include "app/option_table.hpp"

namespace modebank::app {

/// The [study] section's keys.
std::vector<Option> study_options();

}  // namespace modebank::app
