#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// A file in memory for those who write by name and do not say when a disk is full (libmatio): what it holds
/// is whole, and goes to a disk by replace_file.
class MemoryFile {
 public:
  /// Throws DataError where there is no memory.
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// A name of it in this process.
  std::filesystem::path path() const;
  /// All bytes that were written.
  std::string content() const;

 private:
  int descriptor_;
};

}  // namespace modebank
