#include "io/csv/csv_dialect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "io/csv/csv_number.hpp"
#include "io/csv/csv_text.hpp"
#include "io/table/number.hpp"
#include "io/table/stamp_pattern.hpp"

namespace modebank {

namespace {

using Fields = std::vector<std::string>;

constexpr std::size_t looked_at = 30;  // number of rows to examine

/// In the order of Separator; automatic stands for the comma.
char delimiter_of(Separator separator) { return ",,;\t| "[static_cast<std::size_t>(separator)]; }

std::vector<TextRecord> without_comments(std::vector<TextRecord> records) {
  std::erase_if(records, [](const TextRecord& record) { return is_comment(record.text); });
  return records;
}

bool is_value(const std::string& field) {
  static const CsvNumbers with_point(false, {}), with_comma(true, {});
  if (field.empty()) return false;
  const NumberStatus status = with_point.parse(field).status;
  return status == NumberStatus::ok || status == NumberStatus::missing ||
         with_comma.parse(field).status == NumberStatus::ok || is_known_time(field);
}

std::size_t common_width(const std::vector<Fields>& rows) {
  std::map<std::size_t, std::size_t> widths;
  for (const Fields& row : rows) ++widths[row.size()];
  const auto common =
      std::max_element(widths.begin(), widths.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return common == widths.end() ? 0 : common->first;
}

/// The fields of each record. A separator at the end of all rows below the header, or of the header alone, separates
/// nothing.
std::vector<Fields> split(const std::vector<TextRecord>& records, Separator separator) {
  std::vector<Fields> rows;
  for (const TextRecord& record : records) rows.push_back(fields_of(record.text, delimiter_of(separator)));
  const std::size_t width = common_width(rows);
  const auto ends = [&](const Fields& row) { return row.size() != width || row.back().empty(); };
  const bool shorter = std::ranges::any_of(rows, [&](const Fields& row) { return row.size() + 1 == width; });
  const std::size_t ended = width > 2 && shorter && std::ranges::all_of(rows, ends) ? width : width + 1;
  for (Fields& row : rows)
    if (row.size() == ended && row.back().empty()) row.pop_back();
  return rows;
}

/// Score of a separator. It counts two shares: rows with the most frequent width, and fields of these rows that are
/// values.
double score(const std::vector<Fields>& rows) {
  const std::size_t width = common_width(rows);
  if (width < 2) return 0.0;
  const auto common = std::count_if(rows.begin(), rows.end(), [&](const Fields& row) { return row.size() == width; });
  std::size_t values = 0, fields = 0;
  for (const Fields& row : rows)
    for (const std::string& field : row) {
      if (field.empty()) continue;  // a missing value says nothing
      ++fields;
      values += is_value(field) ? 1 : 0;
    }
  return static_cast<double>(common) / static_cast<double>(rows.size()) +
         static_cast<double>(values) / static_cast<double>(fields);
}

Separator find_separator(const std::vector<TextRecord>& records) {
  Separator best = Separator::comma;
  double best_score = 0.0;
  for (const Separator candidate :
       {Separator::comma, Separator::semicolon, Separator::tab, Separator::pipe, Separator::blank})
    if (const double found = score(split(records, candidate)); found > best_score) {
      best = candidate;
      best_score = found;
    }
  return best;
}

bool has_decimal_commas(const std::vector<Fields>& rows, Separator separator) {
  bool comma = false, either_comma = false, either_point = false;
  for (const Fields& row : rows)
    for (const std::string& field : row) {
      const MarkShown shown = mark_shown(field);
      if (shown == MarkShown::point) return false;
      comma = comma || shown == MarkShown::comma;
      either_comma = either_comma || shown == MarkShown::either_comma;
      either_point = either_point || shown == MarkShown::either_point;
    }
  // If commas separate fields, a field that contains a comma is in quotes. Its comma is more often a thousands
  // separator than a decimal mark.
  return comma || (either_comma && !either_point && separator != Separator::comma);
}

bool any_value(const Fields& row) { return std::any_of(row.begin(), row.end(), is_value); }

/// Whether the first two rows have values in the same columns, and in at least one column.
bool is_headless(const std::vector<Fields>& rows, const std::vector<std::string>& na) {
  if (rows.empty() || !any_value(rows[0])) return false;
  if (rows.size() < 2) return true;
  const CsvNumbers words(false, na);
  const auto missing = [&](const std::string& field) { return field.empty() || words.missing_word(field) != nullptr; };
  for (std::size_t i = 0; i < std::min(rows[0].size(), rows[1].size()); ++i)
    if (is_value(rows[0][i]) != is_value(rows[1][i]) && !missing(rows[0][i]) && !missing(rows[1][i])) return false;
  return true;
}

bool has_units_row(const std::vector<Fields>& rows) {
  return rows.size() > 2 && rows[1].size() == rows[0].size() && !any_value(rows[0]) && !any_value(rows[1]) &&
         any_value(rows[2]);
}

/// Names from the last comment before the rows, the place where numpy.savetxt writes them. Empty if the numbers of
/// names and fields differ.
Fields commented_names(const std::vector<TextRecord>& records, Separator separator, std::size_t width) {
  std::string_view last;
  for (const TextRecord& record : records) {
    if (!is_comment(record.text)) break;
    last = record.text;
  }
  while (!last.empty() && (is_comment(last) || last.front() == ' ')) last.remove_prefix(1);
  Fields names = fields_of(last, delimiter_of(separator));
  return names.size() == width && !last.empty() ? names : Fields();
}

}  // namespace

char CsvDialect::delimiter() const { return separator == Separator::blank ? blank_separator : delimiter_of(separator); }

std::size_t lines_above_table(std::string_view text, bool complete, const FormatOptions& options) {
  constexpr std::size_t alike = 5, names_and_units = 2;
  const std::vector<TextRecord> all = first_records(text, complete, rows_looked_at_for_table);
  const std::vector<TextRecord> records = without_comments(all);
  if (records.size() <= names_and_units) return 0;
  const std::vector<TextRecord> second_half(records.begin() + std::ssize(records) / 2, records.end());
  const Separator separator =
      options.separator == Separator::automatic ? find_separator(second_half) : options.separator;
  const std::vector<Fields> rows = split(records, separator);
  const std::size_t width = common_width({rows.begin() + std::ssize(rows) / 2, rows.end()});
  if (width < 2 || rows.front().size() == width) return 0;
  for (std::size_t first = 1; first + names_and_units < rows.size(); ++first) {
    const std::size_t end = std::min(first + alike, rows.size());
    bool found = true;
    for (std::size_t i = first; i < end; ++i)
      found = found && rows[i].size() == width && (i < first + names_and_units || any_value(rows[i]));
    if (!found) continue;
    // R's headers have no name for the row numbers, so such a header looks like a title.
    if (first == 1 && rows[0].size() > 1 && rows[0].size() + 1 == width && any_value(rows[1])) return 0;
    // Comments below the title are kept, because the last comment may name the columns.
    const auto behind = std::find_if(all.begin(), all.end(),
                                     [&](const TextRecord& record) { return record.line > records[first - 1].line; });
    return static_cast<std::size_t>(behind->line) - 1;
  }
  return 0;
}

CsvDialect find_dialect(std::string_view text, bool complete, const FormatOptions& options) {
  CsvDialect dialect;
  dialect.skipped = options.skip_automatic ? lines_above_table(text, complete, options) : options.skip_rows;
  const std::vector<TextRecord> all = first_records(without_first_lines(text, dialect.skipped), complete, looked_at);
  const std::vector<TextRecord> records = without_comments(all);
  dialect.comments = records.size() < all.size();
  dialect.separator = options.separator == Separator::automatic ? find_separator(records) : options.separator;
  const std::vector<Fields> rows = split(records, dialect.separator);
  dialect.width = common_width(rows);
  dialect.decimal_comma = options.decimal == DecimalMark::comma ||
                          (options.decimal == DecimalMark::automatic && has_decimal_commas(rows, dialect.separator));
  const bool headless =
      options.header == HeaderRow::no || (options.header == HeaderRow::automatic && is_headless(rows, options.na));
  std::vector<std::string> said;
  if (dialect.separator != Separator::comma)
    said.push_back(fmt::format("separated by {}s", name_of(dialect.separator)));
  if (dialect.decimal_comma) said.emplace_back("with decimal commas");
  if (headless) {
    dialect.header_rows = 0;
    const std::size_t width = rows.empty() ? 0 : rows[0].size();
    if (options.header == HeaderRow::automatic) dialect.names = commented_names(all, dialect.separator, width);
    if (!dialect.names.empty()) said.emplace_back("with column names in a comment");
    for (std::size_t i = dialect.names.size(); i < width; ++i) dialect.names.push_back(fmt::format("c{}", i + 1));
    if (said.empty() || said.back().find("names") == std::string::npos)
      said.push_back(fmt::format("without a header (columns c1 to c{})", width));
  } else if (has_units_row(rows)) {
    dialect.header_rows = 2;
    said.emplace_back("with units in the second row");
  }
  if (!said.empty())
    dialect.note = fmt::format("text files are read as {} (change it with data.separator, data.decimal or data.header)",
                               fmt::join(said, ", "));
  return dialect;
}

}  // namespace modebank
