#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace modebank {

/// A file that was read, for provenance.
struct InputFile {
  std::string path;  ///< absolute path, with control characters as \x1b, because people read it
  std::uint64_t bytes = 0;
  std::string sha256;  ///< SHA-256 of the content in lowercase hex. For recordings it covers the messages that were
                       ///< used (UsedMessages).
};

/// Path, size and hash of the content of any file. Throws ConfigurationError when it cannot be read.
InputFile describe_file(const std::filesystem::path& path);

/// SHA-256 over the hex digests of the files, in this order. It depends on contents, not on paths.
std::string data_hash(const std::vector<InputFile>& files);

}  // namespace modebank
