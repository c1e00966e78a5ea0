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

inline constexpr const char *archive_format = "modebank", *schema_version = "4.0";

/// The HDF5 user block before an archive's content. Bytes 0-63 are the SHA-256 of all bytes after the block, in
/// lowercase hex. The other bytes are zero.
inline constexpr std::size_t user_block_bytes = 512;
using UserBlock = std::array<char, user_block_bytes>;

UserBlock make_user_block(std::string_view content_sha256);

/// Faults of a user block, given the hash of the content. Empty if the block has no faults.
std::vector<std::string> user_block_problems(const UserBlock& block, std::string_view content_sha256);

/// SHA-256 of all bytes after a file's user block. Throws DataError if the file cannot be read.
std::string content_hash(const std::filesystem::path& path);

/// An archive that is open for reading. The file is opened once and its hash is checked once, through the descriptor
/// that HDF5 reads. Copies share this descriptor. Functions that read an archive only once also accept its path.
class OpenArchive {
 public:
  /// Throws ConfigurationError if the file is missing. Throws DataError with the path if the file is unreadable,
  /// truncated, damaged (wrong hash), not a modebank archive, or of another major schema.
  OpenArchive(const std::filesystem::path& path);  // NOLINT(google-explicit-constructor): see above
  OpenArchive(const std::string& path) : OpenArchive(std::filesystem::path(path)) {}  // NOLINT
  OpenArchive(const char* path) : OpenArchive(std::filesystem::path(path)) {}         // NOLINT

  const std::filesystem::path& path() const;
  /// SHA-256 of the content, as the user block contains it. It identifies the archive.
  const std::string& digest() const;
  /// The root group. Calls of HDF5 functions need an existing hdf5::Quiet.
  hdf5::Handle root() const;

 private:
  struct File;
  std::shared_ptr<const File> file_;
};

/// The root group of an open file.
hdf5::Handle open_root(const hdf5::Handle& file);

}  // namespace modebank
