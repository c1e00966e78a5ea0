#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// How the bank's noise follows state and input, over the training samples where these are at hand; empty where it does
/// not.
std::string noise_factor_text(const Archive& archive, int width);

}  // namespace modebank::app
