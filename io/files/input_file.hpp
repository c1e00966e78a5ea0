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
  std::string sha256;  ///< lowercase hex of the content
};

/// Path, size and hash of any file; of a folder (a recording in parts) the size of its files and the data_hash of them,
/// in order of their names. Throws ConfigurationError when it cannot be read.
InputFile describe_file(const std::filesystem::path& path);

/// SHA-256 over the files' hex digests, in that order: the content, not where it lies.
std::string data_hash(const std::vector<InputFile>& files);

}  // namespace modebank
