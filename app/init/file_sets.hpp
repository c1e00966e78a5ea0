#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Files of one kind, and the pattern with one * that names them and no others, where there is one.
struct FileSet {
  std::vector<std::filesystem::path> files;  ///< absolute, in order of name
  std::string pattern;                       ///< of one file its own path; empty: they have to be listed
  std::vector<std::string> runs;             ///< what the * stands for, per file; without one their stems
};

/// Files sorted into sets, those that share four fifths of either's columns into one, in the order in which they are
/// named. Throws ConfigurationError when one cannot be read.
std::vector<FileSet> file_sets(const std::vector<std::string>& files);

/// The pattern of file names in one folder: what they begin and end with, cut where a word ends (pro_00 and pro_01 are
/// pro_*, not pro_0*); empty when they share neither.
std::string common_pattern(const std::vector<std::string>& names);

}  // namespace modebank::app
