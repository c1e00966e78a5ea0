#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace modebank {

/// A file that was read, for provenance.
struct InputFile {
  std::string path;  ///< absolute; control characters as \x1b, because people read it
  std::uint64_t bytes = 0;
  std::string sha256;  ///< SHA-256 of the content in lowercase hex; for recordings, of the messages that were used
                       ///< (UsedMessages)
};

/// Path, size and hash of the content of any file. Throws ConfigurationError when it cannot be read.
InputFile describe_file(const std::filesystem::path& path);

/// SHA-256 over the files' hex digests, in that order. It depends on contents, not on paths.
std::string data_hash(const std::vector<InputFile>& files);

}  // namespace modebank
