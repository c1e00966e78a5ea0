#pragma once

#include <filesystem>
#include <vector>

namespace modebank {

/// The files of a recording: the file itself, or the files of a folder in the order of writing. metadata.yaml states
/// this order. Without metadata.yaml, all files with the extension .bag, .mcap or .db3 are used, in the order of the
/// numbers in their names.
/// Throws ConfigurationError if the folder has no such files, if they have several extensions, or if metadata.yaml
/// lists a file outside the folder.
std::vector<std::filesystem::path> recording_files(const std::filesystem::path& path);
/// Whether recording_files finds a recording in the folder: metadata.yaml, or a file with one of these extensions.
bool is_recording_folder(const std::filesystem::path& folder);

}  // namespace modebank
