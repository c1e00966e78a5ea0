#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A word that lines of the screen begin with, and what such a line states, for `modebank help`.
struct ScreenLabel {
  std::string name, means;
};

/// Every label of the screens of `run`, `show` and `run LOG`.
const std::vector<ScreenLabel>& screen_labels();

/// "read      ": the label as its line begins. Throws std::logic_error for one that is not in the table.
std::string padded_label(const std::string& name);

}  // namespace modebank::app
