#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>

namespace modebank {

/// Whether an error means that the disk is full or broken. Such an error is not the user's fault.
bool is_disk_failure(const std::error_code& error);

/// Reason why `path` cannot become a regular file. Empty if it can. The folder may be missing or not writable, or
/// `path` may be a folder, device or pipe. Throws DataError if the disk fails.
std::string write_obstacle(const std::filesystem::path& path);

/// Target of the symbolic links in a user's path. The target need not exist. Throws DataError if the links form a loop.
std::filesystem::path final_target(const std::filesystem::path& path);

/// Writes the pieces to `path`, one after another. Steps: temporary name in the same folder (temporary_path), fsync,
/// rename, fsync of the folder.
/// - A file with its final name is complete. On failure the temporary file is removed and the old file stays. The
/// DataError then contains the system's reason.
/// - If `path` is a symbolic link, the file replaces the link, because the folder may belong to somebody else. Users'
/// paths go through final_target first.
/// - The first file that a process writes in a folder removes leftovers of killed processes (remove_leftovers).
void replace_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// Like the function above, for a file that will be moved to `place` together with other files. Messages name `place`.
void write_staged(const std::filesystem::path& staged, const std::filesystem::path& place, std::string_view content);

/// Like the function above, but `fill` writes the file. `fill` receives the temporary path.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& fill);

/// Appends to a file, and creates it if it is missing. If a symbolic link or a second hard link leads to the file, a
/// new file without the old content replaces it. Throws DataError.
void append_to_file(const std::filesystem::path& path, std::string_view text);

/// Makes a folder and its parent folders. A folder replaces a symbolic link of the same name. Throws
/// std::filesystem::filesystem_error.
void make_own_folder(const std::filesystem::path& path);

/// Removes a symbolic link at this path before a file is opened there. Anything else stays.
void remove_link(const std::filesystem::path& path);

}  // namespace modebank
