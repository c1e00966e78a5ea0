#pragma once

#include <vector>

#include "app/option_table.hpp"

namespace modebank::app {

/// The [simulate] section: keys of both systems, then those of one.
std::vector<Option> simulate_options();

}  // namespace modebank::app
