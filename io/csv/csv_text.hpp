#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// Whether a file that begins so is UTF-16: by its byte-order mark, or by zeros in every other byte.
bool is_utf16(std::string_view content);

/// As UTF-8, without a byte-order mark, lines of bytes that are not UTF-8 read as Windows-1252; UTF-8 comes back as it
/// is, without a copy (`storage` keeps any other).
std::string_view as_utf8(std::string_view content, std::string& storage);

/// The text behind so many lines.
std::string_view without_first_lines(std::string_view text, std::size_t lines);

/// The text up to its last row that holds more than separators and blanks, which spreadsheets write below a table.
std::string_view without_empty_tail(std::string_view text, char separator);

/// Records of a text up to its last line break, or to its end if it is `complete`; line breaks within quotes do not end
/// one. Empty lines are left out.
struct TextRecord {
  std::string_view text;
  std::uint64_t line = 1;
};
std::vector<TextRecord> first_records(std::string_view text, bool complete, std::size_t at_most);

/// A comment: '#' or '%' comes first.
bool is_comment(std::string_view record);

/// More than any log has, and few enough that names made of every second byte do not fill the memory.
inline constexpr std::size_t most_csv_columns = 100'000;

/// The fields of a record, without blanks and quotes around them, one more than most_csv_columns at most. `separator`
/// ' ': runs of blanks and tabs.
std::vector<std::string> fields_of(std::string_view record, char separator);

/// What libcsv is given where it would not understand the text: comments become empty lines, which are noted, and runs
/// of blanks `blank_separator`.
inline constexpr char blank_separator = '\x1F';
struct PreparedText {
  std::string text;
  std::vector<std::uint64_t> comment_lines;  ///< counted from `first_line`
};
PreparedText prepare_text(std::string_view text, bool blanks_separate, std::uint64_t first_line);

}  // namespace modebank
