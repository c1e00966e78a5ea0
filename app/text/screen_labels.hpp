#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A label: the word at the start of a line of the screen. `modebank help` explains what this line states.
struct ScreenLabel {
  std::string name, means;
};

/// Every label of the screens of `run`, `show` and `run LOG`.
const std::vector<ScreenLabel>& screen_labels();

/// The label as the start of a line, such as "read ". Throws std::logic_error for a label that is not in the table.
std::string padded_label(const std::string& name);

}  // namespace modebank::app
