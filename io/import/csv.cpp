#include "io/import/csv.hpp"

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <utility>

#include "ident/base/not_a_number.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "io/import/csv_pass.hpp"
#include "io/table/number.hpp"
#include "io/table/stamp_column.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
constexpr std::size_t header_bytes = 1 << 14;  // read at a time while looking for the header
constexpr std::size_t shown_bytes = 60;        // of an offending field in a message

std::string_view without_mark(std::string_view content) {
  if (content.substr(0, byte_order_mark.size()) == byte_order_mark) content.remove_prefix(byte_order_mark.size());
  return content;
}

/// Collects the first row that is not empty.
struct HeaderSink {
  std::vector<std::string> names;
  bool complete = false;
  std::size_t fields = 0;
  std::uint64_t line = 1;
  std::string error;

  bool done() const { return complete; }
  void field(std::string_view text) {
    names.emplace_back(text);
    ++fields;
  }
  void row() { complete = fields > 0; }
};

/// Collects the wanted columns of all rows after the header.
struct TableSink {
  static constexpr int skipped = -1;
  static constexpr auto none = static_cast<std::size_t>(-1);

  std::vector<int> target;  // per column of the file: skipped or position in table.numbers
  std::size_t text_column = none, time_column = none, nanoseconds_column = none;
  std::vector<std::string> header;
  Table table;
  std::vector<bool> may_miss;  // per position in table.numbers
  StampColumn stamps;
  bool time_may_miss;
  std::string nanoseconds;  // of the row, where they have a column of their own
  bool header_seen = false, empty_line_seen = false;
  std::size_t fields = 0;
  std::uint64_t line = 1;
  std::string error;

  explicit TableSink(const TimeRequest& time) : stamps(time, ""), time_may_miss(time.may_miss) {}

  bool done() const { return !error.empty(); }

  void field(std::string_view text) {
    if (fields == 0 && empty_line_seen) error = "empty line before this row";
    const std::size_t column = fields++;
    if (!header_seen || column >= target.size()) return;
    if (column == text_column) table.text.emplace_back(text);
    if (target[column] != skipped) number(column, text);
    if (column == time_column) time(text);
    if (column == nanoseconds_column) nanoseconds = text;
  }

  void time(std::string_view text) {
    const NumberStatus status = stamps.add(text);
    if (status == NumberStatus::ok) return;
    if (status == NumberStatus::missing && time_may_miss)
      stamps.add_missing();
    else
      error = status == NumberStatus::text ? fmt::format(
                                                 "column {}: \"{}\" is no time (seconds, or as "
                                                 "2024-05-01T10:00:00.25Z)",
                                                 header[time_column], text.substr(0, shown_bytes))
                                           : complaint(status, time_column, text);
  }

  void number(std::size_t column, std::string_view text) {
    const ParsedNumber parsed = parse_number(text);
    const bool tolerated = parsed.status == NumberStatus::missing && may_miss[target[column]];
    table.numbers[target[column]].push_back(tolerated ? not_a_number : parsed.value);
    if (parsed.status != NumberStatus::ok && !tolerated) error = complaint(parsed.status, column, text);
  }

  std::string complaint(NumberStatus status, std::size_t column, std::string_view text) const {
    const std::string shown =
        fmt::format("\"{}\"{}", text.substr(0, shown_bytes), text.size() > shown_bytes ? "..." : "");
    const std::string where = fmt::format("column {}: ", header[column]);
    if (status == NumberStatus::missing) return where + "missing value" + (text.empty() ? "" : " (" + shown + ")");
    if (status == NumberStatus::out_of_range) return where + shown + " is too large for a double";
    return where + shown + " is not a number";
  }

  void row() {
    if (fields == 0) {
      empty_line_seen = header_seen;
    } else if (!header_seen) {
      header_seen = true;
    } else if (fields != target.size()) {
      error = fmt::format("{} field{}, but the header has {}", fields, fields == 1 ? "" : "s", target.size());
    } else if (nanoseconds_column != none && !stamps.add_nanoseconds(nanoseconds)) {
      error = fmt::format("column {}: \"{}\" is no number of nanoseconds below 1e9 beside whole seconds",
                          header[nanoseconds_column], nanoseconds);
    } else {
      table.line.push_back(line);
    }
  }
};

/// The first row that is not empty; `next_piece` yields the file piece by piece, an empty one at its end.
template <class NextPiece>
std::vector<std::string> header_of(std::string_view file, NextPiece&& next_piece) {
  HeaderSink sink;
  CsvPass pass(file, sink);
  std::string_view piece = without_mark(next_piece());
  for (; !piece.empty() && !sink.done(); piece = next_piece()) pass.feed(piece);
  pass.finish();
  if (sink.names.empty()) throw ConfigurationError(fmt::format("{} is empty: no header", file));
  return sink.names;
}

TableSink make_sink(std::string_view file, std::vector<std::string> header, const TableRequest& request,
                    std::size_t rows) {
  TableSink sink(request.time);
  sink.target.assign(header.size(), TableSink::skipped);
  if (!request.text.empty()) sink.text_column = column_position(file, header, request.text);
  if (!request.time.column.empty()) {
    sink.time_column = column_position(file, header, request.time.column);
    sink.stamps.reserve(rows);
  }
  if (!request.time.nanoseconds.empty())
    sink.nanoseconds_column = column_position(file, header, request.time.nanoseconds);
  for (std::size_t i = 0; i < request.numbers.size(); ++i)
    sink.target[column_position(file, header, request.numbers[i])] = static_cast<int>(i);
  sink.may_miss = request.may_miss;
  sink.may_miss.resize(request.numbers.size(), false);
  sink.table.numbers.resize(request.numbers.size());
  for (auto& column : sink.table.numbers) column.reserve(rows);
  sink.table.line.reserve(rows);
  sink.header = std::move(header);
  return sink;
}

}  // namespace

std::vector<std::string> read_csv_header(const std::filesystem::path& path) {
  std::ifstream stream = open_file(path);
  std::string buffer(header_bytes, '\0');
  return header_of(path.string(), [&]() -> std::string_view {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    return {buffer.data(), static_cast<std::size_t>(stream.gcount())};
  });
}

Table parse_csv(std::string_view file, std::string_view content, const TableRequest& request) {
  std::vector<std::string> header =
      header_of(file, [rest = content]() mutable { return std::exchange(rest, std::string_view()); });
  const auto rows_at_most = static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n'));
  TableSink sink = make_sink(file, std::move(header), request, rows_at_most);
  CsvPass pass(file, sink);
  pass.feed(without_mark(content));
  pass.finish();
  if (sink.time_column != TableSink::none) sink.stamps.finish(file, sink.table);
  return std::move(sink.table);
}

std::vector<TableInfo> CsvReader::tables() const {
  TableInfo table;
  for (std::string& name : read_csv_header(path_)) table.columns.push_back({std::move(name)});
  return {std::move(table)};
}

std::vector<Table> CsvReader::read(const std::vector<TableRequest>& requests, InputFile& file) const {
  const std::string content = read_file(path_);
  std::vector<Table> tables(requests.size());
  std::string sha256;
  tbb::parallel_invoke([&] { sha256 = sha256_hex(content); },
                       [&] {
                         for (std::size_t i = 0; i < requests.size(); ++i)
                           tables[i] = parse_csv(path_.string(), content, requests[i]);
                       });
  file = {path_.string(), content.size(), std::move(sha256)};
  return tables;
}

}  // namespace modebank
