#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The table of free runs: every filter on training and held-out runs. Empty if filter.simulate is not set.
std::string free_run_text(const Archive& archive, int width = 0);

}  // namespace modebank::app
