#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/hdf5/handle.hpp"

namespace modebank {

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
