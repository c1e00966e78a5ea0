#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace modebank {

/// A file that was read, for provenance.
struct InputFile {
  std::string path;  ///< absolute path; control characters are written as \x1b, because people read the path
  std::uint64_t bytes = 0;
  std::string sha256;  ///< SHA-256 of the content in lowercase hex. For a recording, only the messages that were used
                       ///< are hashed (UsedMessages).
};

/// Path, size and hash of any file's content. Throws ConfigurationError if the file cannot be read.
InputFile describe_file(const std::filesystem::path& path);

/// SHA-256 over the files' hex digests, in the order of the files. The result depends on contents, not on paths.
std::string data_hash(const std::vector<InputFile>& files);

}  // namespace modebank
