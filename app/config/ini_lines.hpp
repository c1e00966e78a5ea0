#pragma once

#include <string>
#include <string_view>
#include <vector>

/// Lines of a configuration file or of a system file (system_file.hpp).
namespace modebank::app {

/// A key as the file states it.
struct FileEntry {
  std::string key, value;
  int line = 0;
  bool has_comment = false, comment_touches_value = false;
};

/// One line at a time through Boost's parser: its grammar, and a line number for every message. Throws
/// ConfigurationError for a line that is neither a section nor key = value. `path`: for messages.
std::vector<FileEntry> parse_lines(std::string_view text, const std::string& path);

/// Whether a key's value is a single path, which may contain any character.
bool is_path(const std::string& key);
/// Whether a key's value may be in double quotes, where \" \\ \n and \x1b have their usual meaning: paths, and column
/// names, which may contain a #. In other keys quotes are part of the value.
bool takes_quotes(const std::string& key);

}  // namespace modebank::app
