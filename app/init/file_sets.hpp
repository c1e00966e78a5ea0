#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Files of one kind. If one pattern with a single * matches exactly these files, it is used.
struct FileSet {
  std::vector<std::filesystem::path> files;  ///< absolute, in order of name
  std::string pattern;                       ///< for a single file its path; empty: the files must be listed
  std::vector<std::string> runs;             ///< the text that * matches, per file; without a pattern the stems
};

/// Sorts files into sets. Two files are of one set if they share at least four fifths of their columns. Order: as
/// named. Throws ConfigurationError when a file cannot be read.
std::vector<FileSet> file_sets(const std::vector<std::string>& files);

/// The pattern of file names in one folder: their common beginning and end, cut at the end of a word. Example: pro_00
/// and pro_01 give pro_*, not pro_0*. Empty when nothing is common.
std::string common_pattern(const std::vector<std::string>& names);

}  // namespace modebank::app
