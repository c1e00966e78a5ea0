#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// Whether a file that begins like this is UTF-16. UTF-16 has a byte-order mark or a zero in every other byte.
bool is_utf16(std::string_view content);

/// The text as UTF-8, without a byte-order mark. Lines that are not UTF-8 are read as Windows-1252. A text in UTF-8 is
/// not copied. Any other text is converted into `storage`.
std::string_view as_utf8(std::string_view content, std::string& storage);

/// The text below the first `lines` lines.
std::string_view without_first_lines(std::string_view text, std::size_t lines);

/// The text without last rows that contain only separators and blanks. Spreadsheets write such rows below a table.
std::string_view without_empty_tail(std::string_view text, char separator);

/// The records of a text, without empty lines. If the text is not `complete`, its unfinished last line is not a record.
/// Line breaks within quotes do not end a record.
struct TextRecord {
  std::string_view text;
  std::uint64_t line = 1;
};
std::vector<TextRecord> first_records(std::string_view text, bool complete, std::size_t at_most);

/// Whether a record is a comment. A comment begins with '#' or '%'.
bool is_comment(std::string_view record);

/// Largest number of columns. No log has this many, and memory suffices even if every second byte were a name.
inline constexpr std::size_t most_csv_columns = 100'000;

/// The fields of a record, without blanks and quotes around them. Returns at most most_csv_columns + 1 fields. If
/// `separator` is ' ', any number of blanks and tabs separates fields.
std::vector<std::string> fields_of(std::string_view record, char separator);

/// Rewrites a text for libcsv. Comments become empty lines, and their line numbers are recorded. Sequences of blanks
/// become `blank_separator`.
inline constexpr char blank_separator = '\x1F';
struct PreparedText {
  std::string text;
  std::vector<std::uint64_t> comment_lines;  ///< line numbers, counted from `first_line`
};
PreparedText prepare_text(std::string_view text, bool blanks_separate, std::uint64_t first_line);

}  // namespace modebank
