#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/format_options.hpp"

namespace modebank {

/// Format of a table in a text file.
struct CsvDialect {
  Separator separator = Separator::comma;
  bool decimal_comma = false;
  std::size_t header_rows = 1;     ///< rows before the first row of numbers: names, units
  std::vector<std::string> names;  ///< names if the first row has none: from a comment, or c1, c2, ...
  bool comments = false;           ///< whether the text has comments
  std::size_t skipped = 0;         ///< number of lines above the table
  std::string note;                ///< remark for the user; empty for RFC 4180

  /// Whether the text must be rewritten for libcsv.
  bool rewritten() const { return comments || separator == Separator::blank; }
  /// Delimiter for libcsv.
  char delimiter() const;
  /// Number of the table's first line in the file.
  std::uint64_t first_line() const { return skipped + 1; }
};

/// The dialect by the first rows of a text (UTF-8; `complete`: the whole text), where `options` do not state it. The
/// separator is the one that splits rows into equally many fields, most of them numbers. The decimal mark is a comma if
/// numbers show it and none shows a point (io/csv/csv_number.hpp). There is a header unless the first row has numbers
/// as the second does. There is a row of units if the second row has no numbers, but the third has. Comments begin with
/// # or %; the last one before the rows names the columns if no header does and it has as many fields.
CsvDialect find_dialect(std::string_view text, bool complete, const FormatOptions& options);

/// Number of title lines above the table: lines before the first of five rows with the most frequent width (or of all
/// rows that follow, if fewer). From the third of these on, rows have values. 0 without a title or without a table.
std::size_t lines_above_table(std::string_view text, bool complete, const FormatOptions& options);

/// Number of rows to search for the end of a title and the dialect after it.
inline constexpr std::size_t rows_looked_at_for_table = 230;

}  // namespace modebank
