#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// The HDF5 user block in front of an archive's content: the lowercase hex SHA-256 of all bytes after the block in
/// bytes 0-63, zeros in the rest.
inline constexpr std::size_t user_block_bytes = 512;
using UserBlock = std::array<char, user_block_bytes>;

UserBlock make_user_block(std::string_view content_sha256);

/// What is wrong with a block whose content has the given hash; empty when nothing is.
std::vector<std::string> user_block_problems(const UserBlock& block, std::string_view content_sha256);

/// SHA-256 of everything after a file's user block. Throws DataError when the file cannot be read.
std::string content_hash(const std::filesystem::path& path);

/// The same for a file's block and content; a file that cannot be read is a problem, too.
std::vector<std::string> hash_problems(const std::filesystem::path& path);

}  // namespace modebank
