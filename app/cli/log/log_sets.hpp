#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/init/file_sets.hpp"

/// The logs that `init` and `run` are given.
namespace modebank::app {

/// file_sets, each of whose files a configuration can name; a folder stands for the logs in it, unless it is one
/// recording. Throws ConfigurationError for a file that no configuration can name, and for a folder without logs.
std::vector<FileSet> nameable_sets(const std::vector<std::string>& logs);

/// The name of what is made of them, after the first set: pro_*.csv gives pro, and drives/*.csv gives drives.
std::string name_after(const std::vector<FileSet>& sets);

std::vector<std::filesystem::path> files_of(const std::vector<FileSet>& sets);

}  // namespace modebank::app
