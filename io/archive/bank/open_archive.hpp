#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/hdf5/handle.hpp"

namespace modebank {

inline constexpr const char *archive_format = "modebank", *schema_version = "3.0";

/// The HDF5 user block in front of an archive's content: the lowercase hex SHA-256 of all bytes after the block in
/// bytes 0-63, zeros in the rest.
inline constexpr std::size_t user_block_bytes = 512;
using UserBlock = std::array<char, user_block_bytes>;

UserBlock make_user_block(std::string_view content_sha256);

/// Faults of a user block, given the hash of the content; empty if there are none.
std::vector<std::string> user_block_problems(const UserBlock& block, std::string_view content_sha256);

/// SHA-256 of all bytes after a file's user block. Throws DataError if the file cannot be read.
std::string content_hash(const std::filesystem::path& path);

/// An archive open for reading. It is opened once, and its hash is checked once, through the descriptor that HDF5
/// reads. Copies share this descriptor. Functions that read an archive only once also accept its path.
class OpenArchive {
 public:
  /// Throws ConfigurationError if the file is missing. Throws DataError with the path for a file that is unreadable,
  /// truncated, damaged (its hash does not match), not a modebank archive, or of another major schema.
  OpenArchive(const std::filesystem::path& path);  // NOLINT(google-explicit-constructor): see above
  OpenArchive(const std::string& path) : OpenArchive(std::filesystem::path(path)) {}  // NOLINT
  OpenArchive(const char* path) : OpenArchive(std::filesystem::path(path)) {}         // NOLINT

  const std::filesystem::path& path() const;
  /// SHA-256 of the content, from the user block: identifies the archive.
  const std::string& digest() const;
  /// The root group. Calls of HDF5 need a living hdf5::Quiet.
  hdf5::Handle root() const;

 private:
  struct File;
  std::shared_ptr<const File> file_;
};

/// The root group of an open file.
hdf5::Handle open_root(const hdf5::Handle& file);

}  // namespace modebank
