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

/// Why `path` cannot become a regular file of ours: its folder is missing or not writable, or a folder, a device or a
/// pipe has the name. Empty when nothing stands in the way. Throws DataError when the disk fails.
std::string write_obstacle(const std::filesystem::path& path);

/// Where the symbolic links of a path that a user named lead, though nothing need be there. Throws DataError when they
/// lead back to themselves.
std::filesystem::path final_target(const std::filesystem::path& path);

/// Makes `path` hold the given pieces, one after the other: temporary name in the same folder (temporary_path), fsync,
/// rename, fsync of the folder. A file under its final name is complete; on failure the temporary is removed, the old
/// file stays and DataError gives the system's reason. A symbolic link of that name is replaced by the file and never
/// written through: the folder may be somebody else's. A path that a user named goes through final_target before. The
/// first file that a process writes in a folder takes away what killed processes left there (remove_leftovers).
void replace_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// The same for a file that will be moved to its place with others: messages name that place.
void write_staged(const std::filesystem::path& staged, const std::filesystem::path& place, std::string_view content);

/// The same with a file that `fill` writes under its temporary name, which it is given.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& fill);

/// Appends to a file of ours, which is made if need be. One that a symbolic link or a second name leads to from
/// elsewhere is not appended to: a file of its own takes its place, without what the link led to. Throws DataError.
void append_to_file(const std::filesystem::path& path, std::string_view text);

/// Makes a folder of ours, and those above it. A symbolic link of that name gives way to a folder. Throws
/// std::filesystem::filesystem_error.
void make_own_folder(const std::filesystem::path& path);

/// Removes a symbolic link of that name, where a file of ours is about to be opened; anything else stays.
void remove_link(const std::filesystem::path& path);

}  // namespace modebank
