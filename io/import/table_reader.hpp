#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/files/input_file.hpp"

namespace modebank {

/// Which columns of a table are wanted; the others are skipped unread and may hold anything.
struct TableRequest {
  std::vector<std::string> numbers;  ///< columns of finite numbers, each once
  std::string text;                  ///< one column of text, or empty
  std::vector<bool> may_miss = {};   ///< per number: whether missing values become NaN; empty: they are errors
};

struct Table {
  std::vector<std::vector<double>> numbers;  ///< one vector per requested column, one value per row
  std::vector<std::string> text;             ///< per row, without blanks around; empty when no column was requested
  std::vector<std::uint64_t> line;           ///< per row, where it starts in the file (messages say file:line), from 1

  std::size_t rows() const { return line.size(); }
};

/// The one seam between files and runs: how a format tells its columns and gives their values. Everything behind it
/// (plans, joining, lags, gaps, roles) knows tables alone. A new format derives a class and is chosen in open_table.
class TableReader {
 public:
  virtual ~TableReader() = default;

  /// Names of the columns, read only as far as needed. Throws ConfigurationError when the file cannot be read or has no
  /// columns, DataError when they are malformed.
  virtual std::vector<std::string> columns() const = 0;

  /// Reads the wanted columns, and says in `file` what was read. Throws as column_position does, and DataError, naming
  /// file, line and column, for text where a number is wanted, a missing value (empty, NaN or infinite) in a column
  /// that may not miss any and a malformed row.
  virtual Table read(const TableRequest& request, InputFile& file) const = 0;
};

/// The reader of a file's format; every file is taken for CSV so far.
std::unique_ptr<TableReader> open_table(const std::filesystem::path& path);

/// Position of a column. Throws ConfigurationError, naming `file`, when it is missing (listing those that exist and the
/// nearest name) or there twice.
std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column);

}  // namespace modebank
