#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/csv/csv_dialect.hpp"

namespace modebank {

/// The dialect of a text and its columns.
struct CsvHead {
  CsvDialect dialect;
  std::vector<std::string> names, units;
};

/// The head of a text, or of its beginning unless it is `complete`. `file`: name for error messages. Throws
/// ConfigurationError if the header is missing. Throws DataError if the header's quotes are malformed.
CsvHead read_csv_head(std::string_view file, std::string_view text, bool complete, const FormatOptions& options);

/// The head of a file. Reads the file only as far as needed.
CsvHead read_csv_head(const std::filesystem::path& path, const FormatOptions& options);

}  // namespace modebank
