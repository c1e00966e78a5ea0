#include "tests/fuzz/read_log.hpp"

#include "io/import/import.hpp"
#include "io/import/open_table.hpp"
#include "tests/fuzz/entry.hpp"

namespace modebank::fuzz {

namespace {

TableRequest request_of(const TableInfo& table, std::size_t position, std::size_t way) {
  TableRequest request;
  request.table = position;
  request.time.may_miss = way % 2 == 0;
  for (const ColumnInfo& column : table.columns) {
    if (request.time.column.empty() && (column.type == "time" || way % 3 == 0))
      request.time.column = column.name;
    else if (column.type == "text" || way % 5 == 0)
      request.texts.push_back(column.name);
    else
      request.numbers.push_back(column.name);
  }
  request.may_miss.assign(request.numbers.size(), request.time.may_miss);
  return request;
}

void check_rows(const Table& table, const TableRequest& request) {
  require(table.numbers.size() == request.numbers.size(), "columns are missing");
  for (const auto& numbers : table.numbers) require(numbers.size() == table.rows(), "columns of different lengths");
  require(table.texts.size() == request.texts.size(), "texts are missing");
  for (const auto& texts : table.texts) require(texts.size() == table.rows(), "texts of different lengths");
  require(request.time.column.empty() || table.time_ns.size() == table.rows(), "times of another length");
}

void import_two(const std::filesystem::path& file, const FormatOptions& format, std::vector<std::string> names,
                std::size_t way) {
  DataOptions options;
  options.root = file.parent_path().string();
  options.inputs = file.filename().string();
  options.format = format;
  options.state = {names.back()};
  options.input = {names[names.size() / 2]};
  if (way % 3 == 0) options.time = {names.front()};
  if (way % 7 == 0) options.run = names.front();
  options.missing = way % 2 == 0 ? Missing::gap : Missing::error;
  options.disorder = way % 4 == 0 ? Disorder::sort : Disorder::error;
  import_data(options);
}

}  // namespace

void read_log(const std::filesystem::path& file, const FormatOptions& format, std::size_t way) {
  const auto reader = open_table(file, format);
  std::vector<TableRequest> requests;
  std::vector<std::string> names;
  const std::vector<TableInfo> tables = reader->tables();
  for (std::size_t t = 0; t < tables.size(); ++t) {
    requests.push_back(request_of(tables[t], t, way));
    for (const ColumnInfo& column : tables[t].columns) names.push_back(column.name);
  }
  if (way % 4 == 1 && !names.empty()) return import_two(file, format, names, way / 4);
  InputFile described;
  const std::vector<Table> read = reader->read(requests, &described);
  for (std::size_t t = 0; t < read.size(); ++t) check_rows(read[t], requests[t]);
}

}  // namespace modebank::fuzz
