#pragma once

#include <filesystem>
#include <string>

namespace modebank {

/// A file in memory for a library that takes file names and does not report a full disk (libmatio). Its content is
/// complete and is written to disk by replace_file.
class MemoryFile {
 public:
  /// Throws DataError without memory.
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
