#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "io/hdf5/handle.hpp"

namespace modebank {

/// An empty archive file, to be filled part by part. Its user block contains zeros until the hash is computed.
hdf5::Handle create_archive_file(const std::filesystem::path& path);
/// Writes the hash into the user block of a closed archive file.
void stamp_hash(const std::filesystem::path& path);

/// Memory in which an archive is made. If the disk is full, no half-written file remains. The bytes depend only on the
/// content.
class ArchiveImage {
 public:
  ArchiveImage();
  const hdf5::Handle& file() const { return file_; }
  /// Returns all bytes after the user block, valid until the next write. Flushes the file.
  std::string_view content() const;

 private:
  hdf5::Handle access_;
  hdf5::Handle file_;
};

}  // namespace modebank
