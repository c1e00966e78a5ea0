#pragma once

#include <string>
#include <vector>

namespace modebank::app {

/// A key that a configuration file is to have.
struct KeyEdit {
  std::string key;                  ///< "section.name"
  std::vector<std::string> values;  ///< one line for each
  std::string comment;              ///< why, in a line above them
};

/// The text of a configuration file with the keys set and all else as it is. A line that set one of them before stays
/// as a comment; a key that the file does not have is put at the end of its section.
std::string edited_text(const std::string& text, const std::vector<KeyEdit>& edits);

}  // namespace modebank::app
