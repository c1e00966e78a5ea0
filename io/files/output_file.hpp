#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A form of files that commands write, and how a file of that form is recognised.
struct FileForm {
  std::string name;                                          ///< with its article: "a checkpoint of track"
  std::function<bool(const std::filesystem::path&)> is_one;  ///< called for regular files that are not empty
};

/// A form that is recognised by what stands near the front of the file: `sign` within the first `within` bytes.
FileForm form_by_front(std::string name, std::string sign, std::size_t within);

/// A file that a user names to be written.
struct OutputFile {
  std::string option;          ///< that names it: "-o", "track.checkpoint"
  std::filesystem::path path;  ///< as it was typed
  FileForm form;               ///< of what is written there
};

/// Guards every output. Throws ConfigurationError, naming option and path, where the file cannot be written,
/// where it is one of `sources` (files that the command reads) by whatever name or link, and where a file is there that
/// is not of the form. A file without content may be replaced. Throws DataError when the disk fails.
void check_output(const OutputFile& output, const std::vector<std::filesystem::path>& sources);

}  // namespace modebank
