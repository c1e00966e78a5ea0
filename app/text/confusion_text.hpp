#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The table of labels and of the bank's most probable modes; empty without labels.
std::string confusion_text(const Archive& archive, int width);

}  // namespace modebank::app
