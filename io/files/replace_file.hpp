#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>

namespace modebank {

/// Whether an error means a full or broken disk, which is not the user's fault.
bool is_disk_failure(const std::error_code& error);

/// Reason why `path` cannot become a regular file; empty if it can. The folder may be missing or not writable, or a
/// folder, device or pipe may have this name. Throws DataError if the disk fails.
std::string write_obstacle(const std::filesystem::path& path);

/// Target of the symbolic links in a user's path; the target need not exist. Throws DataError if the links lead back to
/// themselves.
std::filesystem::path final_target(const std::filesystem::path& path);

/// Writes the pieces to `path`, one after the other: temporary name in the same folder (temporary_path), fsync, rename,
/// fsync of the folder.
/// - A file with its final name is complete. On failure the temporary file is removed, the old file stays, and
///   DataError has the system's reason.
/// - A symbolic link with that name is replaced, never written through, because the folder may belong to somebody else.
///   Users' paths go through final_target first.
/// - The first file that a process writes in a folder removes leftovers of killed processes (remove_leftovers).
void replace_file(const std::filesystem::path& path, std::initializer_list<std::string_view> pieces);

/// The same for a file that will be moved to `place` together with others. Messages name that place.
void write_staged(const std::filesystem::path& staged, const std::filesystem::path& place, std::string_view content);

/// The same, but `fill` writes the file. It gets the temporary path.
void replace_file(const std::filesystem::path& path, const std::function<void(const std::filesystem::path&)>& fill);

/// Appends to a file, which is created if needed. If a symbolic link, or a second hard link, leads to the file from
/// elsewhere, a new file replaces it without the old content. Throws DataError.
void append_to_file(const std::filesystem::path& path, std::string_view text);

/// Makes a folder and those above it. A folder replaces a symbolic link of that name. Throws
/// std::filesystem::filesystem_error.
void make_own_folder(const std::filesystem::path& path);

/// Removes a symbolic link of that name before a file is opened there. Anything else stays.
void remove_link(const std::filesystem::path& path);

}  // namespace modebank
