#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The signals on which the noise factor depends, and its range over the training samples if the archive has these.
/// Empty for a bank without a noise factor.
std::string noise_factor_text(const Archive& archive, int width);

}  // namespace modebank::app
