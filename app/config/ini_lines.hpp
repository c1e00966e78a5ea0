#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/config/faults.hpp"

/// Lines of a configuration file or of a system file (system_file.hpp).
namespace modebank::app {

/// A key and its value, as in the file.
struct FileEntry {
  std::string key, value;
  int line = 0;
  bool has_comment = false, comment_touches_value = false;
};

/// Passes one line at a time to Boost's parser. Its grammar applies, and every message has a line number. A line that
/// is neither a section nor `key = value` is a fault. `path`: the file's name for messages.
std::vector<FileEntry> parse_lines(std::string_view text, const std::string& path, Faults& faults);

/// Whether a key's value is a single path, which may contain any character.
bool is_path(const std::string& key);
/// Whether a key's value may be in double quotes. This holds for paths and for column names, which may contain a #.
/// Inside the quotes \" \\ \n and \x1b have their usual meaning. In all other keys, quotes are part of the value.
bool takes_quotes(const std::string& key);
/// A path as text for a configuration file. It is in double quotes only if it could not be read back without quotes.
std::string path_text(const std::string& path);

}  // namespace modebank::app
