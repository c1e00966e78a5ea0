#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace modebank {

/// One file that was read, for provenance.
struct InputFile {
  std::string path;  ///< absolute; control characters as \x1b, for it is there to be read
  std::uint64_t bytes = 0;
  std::string sha256;  ///< lowercase hex of the content; of a recording, of what is read (UsedMessages)
};

/// Path, size and hash of the content of any file. Throws ConfigurationError when it cannot be read.
InputFile describe_file(const std::filesystem::path& path);

/// SHA-256 over the files' hex digests, in that order: what they hold, not where they lie.
std::string data_hash(const std::vector<InputFile>& files);

}  // namespace modebank
