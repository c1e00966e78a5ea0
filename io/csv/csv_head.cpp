#include "io/csv/csv_head.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "io/csv/csv_pass.hpp"
#include "io/csv/csv_text.hpp"
#include "io/files/read_file.hpp"
#include "io/table/name_unit.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr std::size_t probed_bytes = 1 << 16;  // bytes that are read first, to find dialect and header
constexpr std::size_t most_probed_bytes = 1 << 24;

std::string too_many_columns() { return fmt::format("more than {} columns", most_csv_columns); }

/// Collects the first rows that are not empty.
struct HeaderSink {
  std::size_t wanted = 1;
  std::vector<std::vector<std::string>> rows = {};
  std::size_t complete = 0;
  std::size_t fields = 0;
  std::uint64_t line = 1;
  std::string error;

  bool done() const { return complete == wanted; }
  void field(std::string_view text) {
    if (fields++ == 0) rows.emplace_back();
    if (fields > most_csv_columns) return void(error = too_many_columns());
    rows.back().emplace_back(text);
  }
  void row() { complete += fields > 0 ? 1 : 0; }
};

std::string no_header(std::string_view file, const CsvDialect& dialect) {
  return fmt::format(
      "{} is empty{}, so it has no header", file,
      dialect.skipped > 0 ? fmt::format(" after its first {} lines (data.skip_rows)", dialect.skipped) : "");
}

}  // namespace

CsvHead read_csv_head(std::string_view file, std::string_view text, bool complete, const FormatOptions& options) {
  CsvHead head;
  head.dialect = find_dialect(text, complete, options);
  head.names = head.dialect.names;
  text = without_first_lines(text, head.dialect.skipped);
  if (head.dialect.header_rows > 0) {
    HeaderSink sink;
    sink.wanted = head.dialect.header_rows;
    CsvPass pass(file, sink, head.dialect.delimiter(), head.dialect.first_line());
    std::string prepared;
    if (head.dialect.rewritten()) {
      prepared = prepare_text(text, head.dialect.separator == Separator::blank, head.dialect.first_line()).text;
      text = prepared;
    }
    pass.feed(text);
    if (complete) pass.finish();
    if (sink.rows.empty()) throw ConfigurationError(no_header(file, head.dialect));
    head.names = sink.rows.front();
    if (head.names.size() == head.dialect.width + 1 && head.names.back().empty()) head.names.pop_back();
    if (sink.rows.size() > 1 && head.dialect.header_rows > 1) head.units = sink.rows[1];
  }
  if (head.names.empty()) throw ConfigurationError(no_header(file, head.dialect));
  if (head.names.size() > most_csv_columns) throw DataError(fmt::format("{}: {}", file, too_many_columns()));
  head.units.resize(head.names.size());
  for (std::size_t i = 0; i < head.names.size(); ++i)
    head.units[i] = head.units[i].empty() ? split_unit(head.names[i]).unit : bare_unit(head.units[i]);
  return head;
}

CsvHead read_csv_head(const std::filesystem::path& path, const FormatOptions& options) {
  std::ifstream stream = open_file(path);
  std::string content;
  for (std::size_t wanted = probed_bytes;; wanted *= 4) {
    const std::size_t had = content.size();
    content.resize(wanted);
    stream.read(content.data() + had, static_cast<std::streamsize>(wanted - had));
    content.resize(had + static_cast<std::size_t>(stream.gcount()));
    const bool complete = content.size() < wanted;
    std::string storage;
    const std::string_view text = as_utf8(content, storage);
    // Number of rows to read. It is larger if a title must be skipped.
    const std::size_t enough = options.skip_automatic ? rows_looked_at_for_table : 4;
    const bool enough_bytes = options.skip_automatic && content.size() >= most_probed_bytes;
    if (complete || enough_bytes ||
        first_records(without_first_lines(text, options.skip_rows), false, enough).size() == enough)
      return read_csv_head(path.string(), text, complete, options);
  }
}

}  // namespace modebank
