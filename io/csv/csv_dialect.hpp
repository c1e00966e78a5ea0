#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/format_options.hpp"

namespace modebank {

/// How a text file writes its table.
struct CsvDialect {
  Separator separator = Separator::comma;
  bool decimal_comma = false;
  std::size_t header_rows = 1;     ///< rows before the first of numbers: names, units
  std::vector<std::string> names;  ///< where the first row does not give them: of a comment, or c1, c2, ...
  bool comments = false;           ///< whether there are any
  std::size_t skipped = 0;         ///< lines above the table
  std::string note;                ///< what the user should know; empty for what RFC 4180 describes

  /// Whether libcsv needs the text prepared.
  bool rewritten() const { return comments || separator == Separator::blank; }
  /// For libcsv.
  char delimiter() const;
  /// Number of the table's first line in the file.
  std::uint64_t first_line() const { return skipped + 1; }
};

/// What the first rows of a text (UTF-8; `complete`: all of it) show, where `options` do not say it: the separator that
/// splits them into equally many fields, most of them numbers; a comma as decimal mark where numbers show it and none
/// shows a point (io/csv/csv_number.hpp); a header unless the first row holds numbers as the second does; a row of
/// units where the second holds none, but the third. Comments begin with # or %; the last one before the rows names the
/// columns if nothing else does and it has as many fields.
CsvDialect find_dialect(std::string_view text, bool complete, const FormatOptions& options);

/// Lines of a title above the table: those before the first of five rows (or all that follow) of the width that most
/// rows have, the third of which and those after it hold values. 0 without a title or such a table.
std::size_t lines_above_table(std::string_view text, bool complete, const FormatOptions& options);

/// Rows that are looked at to find the end of a title, and the dialect behind it.
inline constexpr std::size_t rows_looked_at_for_table = 230;

}  // namespace modebank
