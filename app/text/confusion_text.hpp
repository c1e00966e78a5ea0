#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The modes that the bank took each label's samples for; empty without labels.
std::string confusion_text(const Archive& archive, int width);

}  // namespace modebank::app
