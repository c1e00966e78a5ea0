#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Files of one kind. If a pattern with a single * matches exactly these files, the set has this pattern.
struct FileSet {
  std::vector<std::filesystem::path> files;  ///< absolute paths, in order of their names
  std::string pattern;                       ///< for a single file its path; empty if the files must be listed
  std::vector<std::string> runs;             ///< for each file the text that * matches; without a pattern, the file's
                                             ///< stem
};

/// Sorts files into sets. Two files belong to one set if they share at least four fifths of their columns. The sets are
/// in the order of `files`. Throws ConfigurationError if a file cannot be read.
std::vector<FileSet> file_sets(const std::vector<std::string>& files);

/// A path for messages: from the current folder if it lies below that, as people type it.
std::string typed_path(const std::filesystem::path& path);

/// The pattern of file names in one folder, made of their common beginning and end, each cut at a word boundary.
/// Example: pro_00 and pro_01 give pro_*, not pro_0*. Empty if the names have no common part.
std::string common_pattern(const std::vector<std::string>& names);

}  // namespace modebank::app
