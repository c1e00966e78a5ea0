#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The range of the noise factor over the training samples, if the archive has them, and the signals that move it.
/// Empty for a bank without a noise factor.
std::string noise_factor_text(const Archive& archive, int width);

}  // namespace modebank::app
