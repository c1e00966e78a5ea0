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
  std::size_t header_rows = 1;     ///< number of rows before the first row of numbers: names, units
  std::vector<std::string> names;  ///< column names if the first row has none: from a comment, or c1, c2, ...
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

/// Finds the dialect from the first rows of a text in UTF-8, as far as `options` do not state it. `complete`: the text
/// is whole.
/// - Separator: splits rows into equally many fields, most of them numbers.
/// - Decimal mark: a comma if some numbers show a comma and none a point (io/csv/csv_number.hpp).
/// - Header: yes, unless the first row has numbers in the columns in which the second row has numbers.
/// - Row of units: yes, if the second row has no numbers, but the third row has.
/// - Comments begin with # or %. Without a header, the last comment before the rows names the columns if it has as many
///   fields as a row.
CsvDialect find_dialect(std::string_view text, bool complete, const FormatOptions& options);

/// Number of title lines above the table; 0 without a title or without a table. The table begins at the first of five
/// rows with the most frequent width (or of all rows that follow, if there are fewer). From the third of these rows on,
/// rows have values.
std::size_t lines_above_table(std::string_view text, bool complete, const FormatOptions& options);

/// Number of rows in which the end of a title, and the dialect after the title, are searched for.
inline constexpr std::size_t rows_looked_at_for_table = 230;

}  // namespace modebank
