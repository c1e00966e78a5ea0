#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A key to set in a configuration file.
struct KeyEdit {
  std::string key;                  ///< "section.name"
  std::vector<std::string> values;  ///< each value becomes one line
  std::string comment;              ///< reason for the values, written in a comment line above them
};

/// The text of a configuration file after these keys are set. Earlier lines with these keys become comments. A new key
/// is added at the end of its section. All other lines stay unchanged.
std::string edited_text(const std::string& text, const std::vector<KeyEdit>& edits);

}  // namespace modebank::app
