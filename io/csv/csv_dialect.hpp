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
  std::size_t header_rows = 1;     ///< number of rows (names, units) before the first row of numbers
  std::vector<std::string> names;  ///< column names if no row has them: names from a comment, or c1, c2, ...
  std::size_t width = 0;           ///< number of fields in most rows, without an empty one at the end
  bool comments = false;           ///< whether the text has comments
  std::size_t skipped = 0;         ///< number of lines above the table
  std::string note;                ///< remark for the user; empty if the text is plain RFC 4180

  /// Whether the text must be rewritten for libcsv.
  bool rewritten() const { return comments || separator == Separator::blank; }
  /// The delimiter that libcsv gets.
  char delimiter() const;
  /// Number of the table's first line in the file.
  std::uint64_t first_line() const { return skipped + 1; }
};

/// Finds the dialect from the first rows of a text in UTF-8. `options` may already state parts of it. `complete`: these
/// rows are the whole text.
/// - Separator: the character that splits rows into equally many fields, most of them numbers.
/// - Decimal mark: a comma if some numbers contain a decimal comma and no number has a decimal point
/// (io/csv/csv_number.hpp).
/// - Header: absent if the first row has numbers in the columns in which the second row has numbers.
/// - Row of units: the second row, if it has no numbers and the third row has numbers.
/// - Comments begin with # or %. Without a header, the last comment before the rows names the columns. It must have the
/// same number of fields as a row.
CsvDialect find_dialect(std::string_view text, bool complete, const FormatOptions& options);

/// Number of title lines above the table. 0 without a title or without a table. The table begins where five rows in
/// sequence (or all remaining rows, if fewer) have the most frequent width. From the third of these rows on, rows must
/// have values.
std::size_t lines_above_table(std::string_view text, bool complete, const FormatOptions& options);

/// Number of rows in which the end of a title is searched for. The dialect is then searched for in the same number of
/// rows below the title.
inline constexpr std::size_t rows_looked_at_for_table = 230;

}  // namespace modebank
