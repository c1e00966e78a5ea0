#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// A type of file that commands write, and the test that recognises such a file.
struct FileForm {
  std::string name;                                          ///< the type's name with its article: "a page"
  std::function<bool(const std::filesystem::path&)> is_one;  ///< called only for regular files that are not empty
};

/// A form that is recognised by the text `sign` within the first `within` bytes of the file.
FileForm form_by_front(std::string name, std::string sign, std::size_t within);

/// An output file whose path the user has typed.
struct OutputFile {
  std::string option;          ///< the option with the file's path: "-o"
  std::filesystem::path path;  ///< the path as the user typed it
  FileForm form;               ///< form of the file's content
};

/// Checks each output before it is written. Throws ConfigurationError with option and path for
/// - a file that cannot be written,
/// - one of `sources` (input files of the command), by any name or link,
/// - an existing file of another form. An empty file may be replaced.
///
/// Throws DataError if the disk fails.
void check_output(const OutputFile& output, const std::vector<std::filesystem::path>& sources);

}  // namespace modebank
