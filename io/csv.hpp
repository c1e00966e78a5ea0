#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// Comma-separated values (RFC 4180, read by libcsv): a header row names the columns, in any order and with exact case.
/// Fields may be quoted ("" is a quote; commas and line breaks are text there). A byte-order mark, CRLF, blanks around
/// fields, a missing last line break and empty lines before the header or after the last row are accepted; malformed
/// quotes, rows of another width than the header and empty lines between rows are not.

/// Which columns are wanted; the others are skipped unread and may hold anything.
struct CsvRequest {
  std::vector<std::string> numbers;  ///< columns of finite numbers, each once
  std::string text;                  ///< one column of text, or empty
  std::vector<bool> may_miss = {};   ///< per number: whether missing values become NaN; empty: they are errors
};

struct CsvTable {
  std::vector<std::vector<double>> numbers;  ///< one vector per requested column, one value per row
  std::vector<std::string> text;             ///< per row, without blanks around; empty when no column was requested
  std::vector<std::uint64_t> line;           ///< per row, the line of the file on which it starts, from 1

  std::size_t rows() const { return line.size(); }
};

/// Column names of the file, which is read only as far as needed. Throws ConfigurationError when it cannot be read or
/// has no header, DataError when the header's quotes are malformed.
std::vector<std::string> read_csv_header(const std::filesystem::path& path);

/// Position of a column. Throws ConfigurationError, naming `file`, when it is missing (listing those that exist and the
/// nearest name) or there twice.
std::size_t column_position(std::string_view file, const std::vector<std::string>& header, const std::string& column);

/// Reads the wanted columns of `content`, the bytes of `file` (which is only named in messages). Throws as
/// column_position does, and DataError, naming file, line and column, for text where a number is wanted, a missing
/// value (empty, NaN or infinite) in a column that may not miss any and a malformed row.
CsvTable parse_csv(std::string_view file, std::string_view content, const CsvRequest& request);

}  // namespace modebank
