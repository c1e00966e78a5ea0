#pragma once

#include <filesystem>
#include <vector>

namespace modebank {

/// The files of a recording: the file itself, or the files of a folder in the order in which they were written.
/// metadata.yaml states this order. Without metadata.yaml, all files with the extension .bag, .mcap or .db3 are taken,
/// ordered by the numbers in their names. Throws ConfigurationError for a folder without such files or with several
/// extensions, and for a list with a file outside the folder.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& path);

}  // namespace modebank
