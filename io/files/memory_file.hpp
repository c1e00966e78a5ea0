#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// A file in memory. It serves libmatio, which takes file names and does not report a full disk. replace_file then
/// writes the complete content to disk.
class MemoryFile {
 public:
  /// Throws DataError if memory is exhausted.
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// A path that leads to the file, only within this process.
  std::filesystem::path path() const;
  /// All bytes that were written.
  std::string content() const;

 private:
  int descriptor_;
};

}  // namespace modebank
