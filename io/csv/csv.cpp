#include "io/csv/csv.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "ident/base/not_a_number.hpp"
#include "ident/base/utf8.hpp"
#include "ident/base/work_counter.hpp"
#include "io/csv/csv_dialect.hpp"
#include "io/csv/csv_head.hpp"
#include "io/csv/csv_number.hpp"
#include "io/csv/csv_pass.hpp"
#include "io/csv/csv_text.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "io/table/number.hpp"
#include "io/table/stamp_column.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Collects the requested columns of all rows below the header.
struct TableSink {
  static constexpr int skipped = -1;
  static constexpr auto none = static_cast<std::size_t>(-1);

  struct Target {
    int numbers = skipped, texts = skipped;
  };
  std::vector<Target> target;                            // for each column of the file: skipped, or index in the table
  std::size_t time_column = none, second_column = none;  // the columns, if a stamp has two parts in two columns
  std::vector<std::string> header;
  Table table;
  std::vector<bool> may_miss;  // same index as in table.numbers
  StampColumn stamps;
  bool time_may_miss;
  std::string first, second;    // parts of the row's stamp
  std::size_t header_rows = 1;  // number of header rows that are still to come
  CsvNumbers parse;
  bool rows_seen = false, empty_line_seen = false, last_is_empty = false;
  std::vector<std::uint64_t> comment_lines;  // line numbers of the empty lines that replace comments
  std::size_t next_comment = 0;
  std::size_t fields = 0;
  std::uint64_t line = 1;
  std::string error;

  TableSink(const TimeRequest& time, std::string_view time_unit, CsvNumbers numbers)
      : stamps(time, time_unit), time_may_miss(time.may_miss), parse(std::move(numbers)) {}

  bool done() const { return !error.empty(); }

  void field(std::string_view text) {
    if (fields == 0 && empty_line_seen) error = "empty line before this row";
    const std::size_t column = fields++;
    last_is_empty = without_blanks(text).empty();
    if (header_rows > 0 || column >= target.size()) return;
    if (target[column].texts != skipped) table.texts[static_cast<std::size_t>(target[column].texts)].emplace_back(text);
    if (target[column].numbers != skipped) number(column, static_cast<std::size_t>(target[column].numbers), text);
    if (column == time_column && second_column == none) time(text);
    if (second_column == none) return;
    if (column == time_column) first = text;
    if (column == second_column) second = text;
  }

  void time(std::string_view text) {
    const NumberStatus status = add_stamp(text);
    if (status != NumberStatus::ok) no_time(status, text);
  }

  void time_of_two() {
    const NumberStatus status = stamps.add(first, second);
    if (status != NumberStatus::ok) no_time(status, fmt::format("{} {}", first, second));
  }

  void no_time(NumberStatus status, std::string_view text) {
    if (status == NumberStatus::missing && time_may_miss)
      stamps.add_missing();
    else
      error = fmt::format("column {}: {}", header[time_column], stamps.complaint(status, text));
  }

  NumberStatus add_stamp(std::string_view text) {
    if (parse.missing_word(text) != nullptr) return NumberStatus::missing;
    if (!parse.decimal_comma())
      if (const NumberStatus status = stamps.add(text); status != NumberStatus::text) return status;
    if (const std::optional<std::string> number = parse.with_point(text)) return stamps.add(*number);
    // With decimal commas, 12.5 is an error. Dates keep their points.
    const bool other_mark = parse_number(text).status == NumberStatus::ok;
    return other_mark || !parse.decimal_comma() ? NumberStatus::text : stamps.add(commas_as_points(text));
  }

  void number(std::size_t column, std::size_t position, std::string_view text) {
    const ParsedNumber parsed = parse.parse(text);
    const bool tolerated = parsed.status == NumberStatus::missing && may_miss[position];
    if (tolerated && !text.empty())
      if (const std::string* const word = parse.missing_word(text)) ++table.missing_words[*word];
    table.numbers[position].push_back(tolerated ? not_a_number : parsed.value);
    if (parsed.status != NumberStatus::ok && !tolerated) error = complaint(parsed.status, column, text);
  }

  std::string complaint(NumberStatus status, std::size_t column, std::string_view text) const {
    const std::string shown = shown_field(text);
    const std::string where = fmt::format("column {}: ", header[column]);
    if (status != NumberStatus::text) return where + unusable_number(status, text);
    const MarkShown mark = mark_shown(text);
    if (mark == MarkShown::none) return where + shown + " is not a number";
    return where + shown +
           (parse.decimal_comma() ? " is not a number with a decimal comma"
            : mark == MarkShown::either_comma
                ? " is ambiguous (thousands or a decimal comma), since other numbers have a decimal point"
                : " is not a number with a decimal point") +
           " (data.decimal)";
  }

  void row() {
    if (fields == 0) {
      if (is_comment_line()) return;
      empty_line_seen = header_rows == 0 && rows_seen;
    } else if (header_rows > 0) {
      --header_rows;
      rows_seen = true;
    } else if (fields != target.size() && !(fields == target.size() + 1 && last_is_empty)) {
      error = fmt::format("{} field{}, but the header has {}", fields, fields == 1 ? "" : "s", target.size());
    } else {
      table.line.push_back(line);
      rows_seen = true;
      if (second_column != none) time_of_two();
    }
  }

  bool is_comment_line() {
    while (next_comment < comment_lines.size() && comment_lines[next_comment] < line) ++next_comment;
    return next_comment < comment_lines.size() && comment_lines[next_comment] == line;
  }
};

TableInfo table_of(CsvHead head) {
  TableInfo table;
  for (std::size_t i = 0; i < head.names.size(); ++i)
    table.columns.push_back({std::move(head.names[i]), std::move(head.units[i])});
  table.skipped = head.dialect.skipped;
  return table;
}

TableSink make_sink(std::string_view file, const CsvHead& head, const TableRequest& request, std::size_t rows,
                    const std::vector<std::string>& na) {
  std::vector<std::string> header = head.names;
  const auto time = std::find(header.begin(), header.end(), request.time.column);
  TableSink sink(request.time, time == header.end() ? "" : head.units[static_cast<std::size_t>(time - header.begin())],
                 CsvNumbers(head.dialect.decimal_comma, na));
  sink.target.resize(header.size());
  for (std::size_t i = 0; i < request.texts.size(); ++i)
    sink.target[column_position(file, header, request.texts[i])].texts = static_cast<int>(i);
  sink.table.texts.resize(request.texts.size());
  if (!request.time.column.empty()) {
    sink.time_column = column_position(file, header, request.time.column);
    sink.stamps.reserve(rows);
  }
  if (!request.time.second.empty()) sink.second_column = column_position(file, header, request.time.second);
  for (std::size_t i = 0; i < request.numbers.size(); ++i)
    sink.target[column_position(file, header, request.numbers[i])].numbers = static_cast<int>(i);
  sink.may_miss = request.may_miss;
  sink.may_miss.resize(request.numbers.size(), false);
  sink.table.numbers.resize(request.numbers.size());
  for (auto& column : sink.table.numbers) column.reserve(rows);
  sink.table.line.reserve(rows);
  sink.header = std::move(header);
  return sink;
}

/// Whether a comment follows the first rows.
bool has_late_comment(std::string_view text) {
  for (std::size_t at = text.find('#'); at != std::string_view::npos; at = text.find('#', at + 1))
    if (at > 0 && text[at - 1] == '\n') return true;
  return false;
}

/// Reads the columns of one request from a text whose head was already read.
Table parse_rows(std::string_view file, std::string_view text, const CsvHead& head, const TableRequest& request,
                 const std::vector<std::string>& na) {
  const auto rows_at_most = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  TableSink sink = make_sink(file, head, request, rows_at_most, na);
  sink.header_rows = head.dialect.header_rows;
  PreparedText prepared;
  const std::string_view first = text.substr(0, text.find('\n'));
  const auto again = first.empty() || is_comment(first) ? std::string::npos : text.find(fmt::format("\n{}", first));
  if (head.dialect.header_rows > 0 && again < text.size())
    throw DataError(fmt::format(
        "{0}:{1}: the header again; leave it out: python3 -c \"a = open('{0}').readlines(); "
        "open('one.csv', 'w').writelines(c for i, c in enumerate(a) if i == {2} or c.strip() != a[{2}].strip())\"",
        file, head.dialect.first_line() + 1 + std::ranges::count(text.substr(0, again), '\n'), head.dialect.skipped));
  if (head.dialect.rewritten() || has_late_comment(text)) {
    prepared = prepare_text(text, head.dialect.separator == Separator::blank, head.dialect.first_line());
    sink.comment_lines = std::move(prepared.comment_lines);
    text = prepared.text;
  }
  CsvPass pass(file, sink, head.dialect.delimiter(), head.dialect.first_line());
  constexpr std::size_t portion_bytes = 1'000'000;
  WorkCounter counter("MB of " + std::filesystem::path(file).filename().string(), text.size() / portion_bytes);
  for (; text.size() > portion_bytes; counter.add()) {
    pass.feed(text.substr(0, portion_bytes));
    text.remove_prefix(portion_bytes);
  }
  pass.feed(text);
  pass.finish();
  if (sink.time_column != TableSink::none) sink.stamps.finish(file, sink.table);
  if (!head.dialect.note.empty()) sink.table.notes.push_back(head.dialect.note);
  if (const std::size_t skipped = head.dialect.skipped; skipped > 0)
    sink.table.notes.push_back(fmt::format("{} line{} above the table {} skipped (data.skip_rows)", skipped,
                                           skipped == 1 ? "" : "s", skipped == 1 ? "is" : "are"));
  return std::move(sink.table);
}

std::vector<Table> parse_all(std::string_view file, std::string_view content, const std::vector<TableRequest>& requests,
                             const FormatOptions& options) {
  std::string storage;
  const std::string_view text = as_utf8(content, storage);
  const CsvHead head = read_csv_head(file, text, true, options);
  std::vector<Table> tables;
  const std::string_view rows =
      without_empty_tail(without_first_lines(text, head.dialect.skipped),
                         head.dialect.separator == Separator::blank ? ' ' : head.dialect.delimiter());
  for (const TableRequest& request : requests) {
    tables.push_back(parse_rows(file, rows, head, request, options.na));
    if (text.data() == storage.data() && !is_utf16(content)) tables.back().notes.emplace_back(read_as_windows_1252);
  }
  return tables;
}

}  // namespace

Table parse_csv(std::string_view file, std::string_view content, const TableRequest& request,
                const FormatOptions& options) {
  return std::move(parse_all(file, content, {request}, options).front());
}

TableInfo csv_columns(std::string_view file, std::string_view content, const FormatOptions& options) {
  std::string storage;
  return table_of(read_csv_head(file, as_utf8(content, storage), true, options));
}

std::vector<TableInfo> CsvReader::tables() const { return {table_of(read_csv_head(path_, options_))}; }

InputFile CsvReader::describe(const std::vector<TableRequest>&) const { return describe_file(path_); }

std::vector<Table> CsvReader::read(const std::vector<TableRequest>& requests, InputFile* file) const {
  const std::string content = read_file(path_);
  if (file == nullptr) return parse_all(path_.string(), content, requests, options_);
  std::vector<Table> tables;
  std::string sha256;
  tbb::parallel_invoke([&] { sha256 = sha256_hex(content); },
                       [&] { tables = parse_all(path_.string(), content, requests, options_); });
  *file = {path_.string(), content.size(), std::move(sha256)};
  return tables;
}

}  // namespace modebank
