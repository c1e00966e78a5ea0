#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/init/file_sets.hpp"

/// The logs that are given to `init` and `run`.
namespace modebank::app {

/// The result of file_sets, for files that a configuration can name. A folder is replaced by its logs, unless it is one
/// recording. Throws ConfigurationError for a file that no configuration can name, and for a folder without logs.
std::vector<FileSet> nameable_sets(const std::vector<std::string>& logs);

/// Name for the output files, from the first set: pro_*.csv gives pro, and drives/*.csv gives drives.
std::string name_after(const std::vector<FileSet>& sets);

std::vector<std::filesystem::path> files_of(const std::vector<FileSet>& sets);

}  // namespace modebank::app
