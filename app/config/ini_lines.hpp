#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/config/faults.hpp"

/// Lines of a configuration file or of a system file (system_file.hpp).
namespace modebank::app {

/// A key as the file states it.
struct FileEntry {
  std::string key, value;
  int line = 0;
  bool has_comment = false, comment_touches_value = false;
};

/// One line at a time through Boost's parser: its grammar, and a line number for every message. A line that is neither
/// a section nor key = value is a fault. `path`: for messages.
std::vector<FileEntry> parse_lines(std::string_view text, const std::string& path, Faults& faults);

/// Whether a key's value is a single path, which may contain any character.
bool is_path(const std::string& key);
/// Whether a key's value may be in double quotes, where \" \\ \n and \x1b have their usual meaning: paths, and column
/// names, which may contain a #. In other keys quotes are part of the value.
bool takes_quotes(const std::string& key);

}  // namespace modebank::app
