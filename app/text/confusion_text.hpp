#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// A table of the labels against the bank's most probable modes; empty without labels.
std::string confusion_text(const Archive& archive, int width);

}  // namespace modebank::app
