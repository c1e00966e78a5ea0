#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/hdf5/handle.hpp"
#include "io/hdf5/links.hpp"

namespace modebank {

inline constexpr const char *archive_format = "modebank", *schema_version = "2.0";

/// The HDF5 user block in front of an archive's content: the lowercase hex SHA-256 of all bytes after the block in
/// bytes 0-63, zeros in the rest.
inline constexpr std::size_t user_block_bytes = 512;
using UserBlock = std::array<char, user_block_bytes>;

UserBlock make_user_block(std::string_view content_sha256);

/// What is wrong with a block whose content has the given hash; empty when nothing is.
std::vector<std::string> user_block_problems(const UserBlock& block, std::string_view content_sha256);

/// SHA-256 of everything after a file's user block. Throws DataError when the file cannot be read.
std::string content_hash(const std::filesystem::path& path);

/// What is wrong with a file's user block and content; a file that cannot be read is a problem, too.
std::vector<std::string> hash_problems(const std::filesystem::path& path);

/// Throws ConfigurationError when there is no such path and DataError when it is not a regular file that can be read.
void require_readable(const std::filesystem::path& path);

/// before: HDF5 sees no byte of a file whose hash is wrong. unchecked: for those that have just checked it themselves.
enum class HashCheck { before, unchecked };

/// Opens an existing archive for reading, after it has been seen to be one: a regular file with a user block, HDF5's
/// signature, our format and a schema no newer than ours. Throws as read_archive does; messages name the path.
hdf5::Handle open_archive(const std::filesystem::path& path, HashCheck hash);

/// The root group of an open archive.
hdf5::Handle open_root(const hdf5::Handle& file);

}  // namespace modebank
