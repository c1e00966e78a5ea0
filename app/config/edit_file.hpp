#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A key to set in a configuration file.
struct KeyEdit {
  std::string key;                  ///< "section.name"
  std::vector<std::string> values;  ///< one line for each
  std::string comment;              ///< the reason, written in a line above them
};

/// The text of a configuration file with these keys set and everything else unchanged. Lines that set them before stay
/// as comments. A new key is put at the end of its section.
std::string edited_text(const std::string& text, const std::vector<KeyEdit>& edits);

}  // namespace modebank::app
