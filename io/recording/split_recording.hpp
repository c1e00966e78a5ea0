#pragma once

#include <filesystem>
#include <vector>

namespace modebank {

/// The files of a recording: the file itself, or those of a folder, in the order of recording: as metadata.yaml lists
/// them, else all of one ending (.bag, .mcap or .db3) by the numbers in their names. Throws ConfigurationError for a
/// folder of none or of several endings, and for a list that leads out of the folder.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& path);

}  // namespace modebank
