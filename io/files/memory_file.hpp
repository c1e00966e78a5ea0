#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// A file in memory, for a library that takes file names and does not report a full disk (libmatio). replace_file then
/// writes the complete content to disk.
class MemoryFile {
 public:
  /// Throws DataError if memory is exhausted.
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int descriptor() const { return descriptor_; }
  /// The path of the file in this process.
  std::filesystem::path path() const;
  /// All bytes that were written.
  std::string content() const;

 private:
  int descriptor_;
};

}  // namespace modebank
