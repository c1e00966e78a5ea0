#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A word at the start of a line of the screen, and what this line states, for `modebank help`.
struct ScreenLabel {
  std::string name, means;
};

/// Every label of the screens of `run`, `show` and `run LOG`.
const std::vector<ScreenLabel>& screen_labels();

/// "read ": the label as its line begins. Throws std::logic_error for a label that is not in the table.
std::string padded_label(const std::string& name);

}  // namespace modebank::app
