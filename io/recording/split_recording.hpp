#pragma once

#include <filesystem>
#include <vector>

namespace modebank {

/// The files of a recording: the file itself, or those of a folder in the order in which they were written. That order
/// is in metadata.yaml; without it all files of one ending (.bag, .mcap or .db3) are taken, by the numbers in their
/// names. Throws ConfigurationError for a folder with no ending or several, and for a list that leaves the folder.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& path);

}  // namespace modebank
