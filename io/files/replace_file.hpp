#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>

namespace modebank {

/// Whether a disk is full or broken: nobody's mistake in what was asked for.
bool is_disk_failure(const std::error_code& error);

/// Why `path` cannot become a regular file of ours: its folder is missing or not writable, or something that is not a
/// regular file has the name. Empty when nothing stands in the way. Throws DataError when the disk fails.
std::string write_obstacle(const std::filesystem::path& path);

/// What is written when `path` is: where its symbolic links lead, though nothing need be there. Throws DataError when
/// they lead nowhere.
std::filesystem::path final_target(const std::filesystem::path& path);

/// Makes `path` hold the given pieces, one after the other: temporary name in the same folder (temporary_path), fsync,
/// rename, fsync of the folder. A file under its final name is complete; on failure the temporary is removed, the old
/// file stays and DataError gives the system's reason. Symbolic links are written through (final_target). The first
/// file that a process writes in a folder takes away what killed processes left there (remove_leftovers).
void replace_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// The same for a file that will be moved to its place with others: messages name that place.
void write_staged(const std::filesystem::path& staged, const std::filesystem::path& place, std::string_view content);

/// The same with a file that `fill` writes under its temporary name, which it is given.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& fill);

}  // namespace modebank
