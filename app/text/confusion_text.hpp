#pragma once

#include <string>

#include "io/archive/archive.hpp"

namespace modebank::app {

/// The modes that the bank took each label's samples for, and the label of each mode that has one; empty without
/// labels.
std::string confusion_text(const Archive& archive, int width);

/// The label that holds at least 60 % of a mode's samples; empty without.
std::string label_of_mode(const Archive& archive, Eigen::Index mode);

}  // namespace modebank::app
