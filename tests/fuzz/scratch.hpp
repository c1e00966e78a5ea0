#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace modebank::fuzz {

/// A file or folder of this process in memory (/dev/shm where there is one), which is removed when it ends.
std::filesystem::path scratch(std::string_view name);
/// The same with this content; the file is written anew each time.
std::filesystem::path scratch_file(std::string_view name, std::string_view content);
/// All bytes of a file; none where it cannot be read.
std::string content_of(const std::filesystem::path& path);
/// Where scratch lies; called before the first use, by the process that removes it.
void set_scratch_folder(const std::filesystem::path& folder);

}  // namespace modebank::fuzz
