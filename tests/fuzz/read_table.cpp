#include "tests/fuzz/read_table.hpp"

#include <functional>
#include <stdexcept>

#include "io/import/import.hpp"
#include "io/import/open_table.hpp"

namespace modebank::fuzz {

namespace {

template <class Enum>
Enum any_of(Random& chances) {
  const auto& names = EnumNames<Enum>::values;
  return static_cast<Enum>(chances.below(names.size()));
}

FormatOptions some_format(Random& chances) {
  FormatOptions format;
  if (chances.one_in(2)) format.separator = any_of<Separator>(chances);
  if (chances.one_in(2)) format.decimal = any_of<DecimalMark>(chances);
  if (chances.one_in(2)) format.header = any_of<HeaderRow>(chances);
  return format;
}

TableRequest some_request(const TableInfo& table, std::size_t position, Random& chances) {
  TableRequest request;
  request.table = position;
  for (const ColumnInfo& column : table.columns) {
    const bool is_text = column.type == "text" || chances.one_in(20);
    if (column.type == "time" || (request.time.column.empty() && chances.one_in(8)))
      (request.time.second.empty() && !request.time.column.empty() && chances.one_in(6) ? request.time.second
                                                                                        : request.time.column) =
          column.name;
    else if (is_text)
      request.texts.push_back(column.name);
    else
      request.numbers.push_back(column.name);
  }
  request.time.unit = any_of<TimeUnit>(chances);
  if (chances.one_in(8)) request.time.format = "%d.%m.%Y %H:%M:%S.%f";
  request.time.may_miss = !chances.one_in(4);
  for (std::size_t i = 0; i < request.numbers.size(); ++i) request.may_miss.push_back(!chances.one_in(6));
  return request;
}

void check_rows(const Table& table, const TableRequest& request) {
  const auto must = [](bool holds, const char* what) {
    if (!holds) throw std::logic_error(what);
  };
  must(table.numbers.size() == request.numbers.size(), "columns are missing");
  for (const auto& numbers : table.numbers) must(numbers.size() == table.rows(), "columns of different lengths");
  must(table.texts.size() == request.texts.size(), "texts are missing");
  for (const auto& texts : table.texts) must(texts.size() == table.rows(), "texts of different lengths");
  must(request.time.column.empty() || table.time_ns.size() == table.rows(), "times of another length");
}

}  // namespace

Random chances_of(std::string_view input) { return Random(std::hash<std::string_view>()(input)); }

void read_all_tables(const std::filesystem::path& file, Random& chances) {
  const auto reader = open_table(file, some_format(chances));
  std::vector<TableRequest> requests;
  const std::vector<TableInfo> tables = reader->tables();
  for (std::size_t t = 0; t < tables.size(); ++t) requests.push_back(some_request(tables[t], t, chances));
  InputFile described;
  const std::vector<Table> read = reader->read(requests, &described);
  for (std::size_t t = 0; t < read.size(); ++t) check_rows(read[t], requests[t]);
}

void import_some(const std::filesystem::path& file, Random& chances) {
  DataOptions options;
  options.root = file.parent_path().string();
  options.inputs = file.filename().string();
  options.format = some_format(chances);
  std::vector<std::string> names;
  for (const TableInfo& table : open_table(file, options.format)->tables())
    for (const ColumnInfo& column : table.columns) names.push_back(column.name);
  if (names.empty()) return;
  options.state = {chances.pick(names)};
  if (!chances.one_in(6)) options.input = {chances.pick(names)};
  if (chances.one_in(3)) options.time = {chances.pick(names)};
  if (chances.one_in(5)) options.run = chances.pick(names);
  if (chances.one_in(5)) options.label = chances.pick(names);
  if (chances.one_in(8)) options.weight = chances.pick(names);
  if (chances.one_in(8)) options.truth = {chances.pick(names)};
  options.time_unit = any_of<TimeUnit>(chances);
  options.join = any_of<Join>(chances);
  options.missing = any_of<Missing>(chances);
  options.disorder = any_of<Disorder>(chances);
  if (chances.one_in(4)) options.rate_hz = chances.pick({0.5, 10.0, 1000.0});
  if (chances.one_in(4)) options.quantum_auto = true;
  if (chances.one_in(6)) options.lag_s = 0.25;
  import_data(options);
}

}  // namespace modebank::fuzz
