#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The lines of a configuration file, or of a system's (system_file.hpp).
namespace modebank::app {

/// A key as it stands in a file.
struct FileEntry {
  std::string key, value;
  int line = 0;
  bool has_comment = false, comment_touches_value = false;
};

/// One line at a time through Boost's parser: its grammar, and a line number for every message. Throws
/// ConfigurationError for a line that is neither a section nor key = value. `path`: for messages.
std::vector<FileEntry> parse_lines(std::string_view text, const std::string& path);

/// Whether a key's value is one path, which may hold any character.
bool is_path(const std::string& key);
/// Whether a key's value may stand in double quotes, with \" \\ \n and \x1b inside: paths, and names of columns,
/// which may hold a #. Elsewhere quotes are part of the value.
bool takes_quotes(const std::string& key);

}  // namespace modebank::app
