#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace modebank {

/// Whether a file with this beginning is UTF-16: by its byte-order mark, or by zeros in every other byte.
bool is_utf16(std::string_view content);

/// The text as UTF-8, without a byte-order mark. Lines that are not UTF-8 are read as Windows-1252. UTF-8 is returned
/// without a copy; any other text is converted into `storage`.
std::string_view as_utf8(std::string_view content, std::string& storage);

/// The text after this number of lines.
std::string_view without_first_lines(std::string_view text, std::size_t lines);

/// The text without its last rows of only separators and blanks. Spreadsheets write such rows below a table.
std::string_view without_empty_tail(std::string_view text, char separator);

/// Records of a text up to its last line break, or to its end if it is `complete`. Line breaks within quotes do not end
/// a record. Empty lines are left out.
struct TextRecord {
  std::string_view text;
  std::uint64_t line = 1;
};
std::vector<TextRecord> first_records(std::string_view text, bool complete, std::size_t at_most);

/// Whether a record is a comment: it begins with '#' or '%'.
bool is_comment(std::string_view record);

/// More columns than any log has, but few enough for memory even if every second byte were a name.
inline constexpr std::size_t most_csv_columns = 100'000;

/// The fields of a record, without blanks and quotes around them; at most most_csv_columns + 1. `separator` ' ' means
/// any number of blanks and tabs.
std::vector<std::string> fields_of(std::string_view record, char separator);

/// Rewrites text for libcsv: comments become empty lines, whose numbers are recorded, and sequences of blanks become
/// `blank_separator`.
inline constexpr char blank_separator = '\x1F';
struct PreparedText {
  std::string text;
  std::vector<std::uint64_t> comment_lines;  ///< counted from `first_line`
};
PreparedText prepare_text(std::string_view text, bool blanks_separate, std::uint64_t first_line);

}  // namespace modebank
