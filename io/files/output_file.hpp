#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A type of file that commands write, and the test by which such a file is recognised.
struct FileForm {
  std::string name;                                          ///< with its article: "a checkpoint of track"
  std::function<bool(const std::filesystem::path&)> is_one;  ///< called for regular files that are not empty
};

/// A form that is recognised by text near the start of the file: `sign` within the first `within` bytes.
FileForm form_by_front(std::string name, std::string sign, std::size_t within);

/// An output file that a user names.
struct OutputFile {
  std::string option;          ///< the option that names it: "-o", "track.checkpoint"
  std::filesystem::path path;  ///< path as typed
  FileForm form;               ///< form of its content
};

/// Protects every output. Throws ConfigurationError with option and path for
/// - a file that cannot be written,
/// - one of `sources` (input files of the command), by any name or link,
/// - an existing file of another form. An empty file may be replaced.
///
/// Throws DataError if the disk fails.
void check_output(const OutputFile& output, const std::vector<std::filesystem::path>& sources);

}  // namespace modebank
