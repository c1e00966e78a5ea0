#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/archive.hpp"
#include "io/hdf5_handle.hpp"

namespace modebank {

inline constexpr const char* archive_format = "modebank";

/// Opens an existing archive for reading, after it has been seen to be one: a regular file with a user block, HDF5's
/// signature, our format and a schema no newer than ours. Throws as read_archive does; messages name the path.
hdf5::Handle open_archive(const std::filesystem::path& path);

/// Throws ConfigurationError when there is no such path and DataError when it is not a regular file that can be read.
void require_readable(const std::filesystem::path& path);

/// The root group of an open archive.
hdf5::Handle open_root(const hdf5::Handle& file);

/// An empty archive in a file of its own, to be filled piece by piece; its user block is zero until the hash is known.
hdf5::Handle create_archive_file(const std::filesystem::path& path);
/// Fills in the user block of such a file once it is closed.
void stamp_hash(const std::filesystem::path& path);

/// An archive in the making. It lives in memory, so a full disk cannot leave HDF5 with a half-flushed file, and its
/// bytes depend on its content alone.
class ArchiveImage {
 public:
  ArchiveImage();
  const hdf5::Handle& file() const { return file_; }
  /// All bytes after the user block; valid until something is written. Flushes.
  std::string_view content() const;

 private:
  hdf5::Handle access_;
  hdf5::Handle file_;
};

}  // namespace modebank
