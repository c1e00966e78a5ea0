#include "python/bindings/tables.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "io/import/open_table.hpp"
#include "io/table/memory_table.hpp"
#include "modebank/base/error.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"
#include "python/bindings/keys.hpp"

namespace modebank::python {

namespace {

MemoryColumn column_of(const std::string& name, py::handle values) {
  if (py::isinstance<py::list>(values)) return {{name}, values.cast<std::vector<std::string>>()};
  const auto array = py::reinterpret_borrow<py::array>(values);
  const auto rows = static_cast<std::size_t>(array.size());
  if (array.dtype().kind() == 'M')
    return {{name, "ns", "time"}, std::span(static_cast<const std::int64_t*>(array.data()), rows)};
  if (array.dtype().kind() == 'i') return {{name}, std::span(static_cast<const std::int64_t*>(array.data()), rows)};
  return {{name}, std::span(static_cast<const double*>(array.data()), rows)};
}

std::shared_ptr<const TableReader> table_of(const std::string& name, const py::dict& columns) {
  std::vector<MemoryColumn> of_table;
  for (const auto& [column, values] : columns) of_table.push_back(column_of(py::str(column), values));
  return std::make_shared<MemoryTable>(name, std::move(of_table));
}

/// One column of a file: numbers, else texts; nothing where it is neither. Stamps as nanoseconds since 1970.
using FileColumn =
    std::variant<std::monostate, std::vector<double>, std::vector<std::string>, std::vector<std::int64_t>>;
using FileColumns = std::vector<std::vector<FileColumn>>;  // of each table

/// What is asked of a table at once, and the columns that it gives.
struct Piece {
  TableRequest request;
  std::vector<std::size_t> columns;

  void into(Table&& table, FileColumns& result) const {
    std::vector<FileColumn>& of_table = result[request.table];
    for (std::size_t i = 0; i < request.numbers.size(); ++i) of_table[columns[i]] = std::move(table.numbers[i]);
    if (!request.text.empty()) of_table[columns.front()] = std::move(table.text);
    if (!request.time.column.empty()) of_table[columns.front()] = std::move(table.time_ns);
  }
};

Piece one_column(std::size_t table, std::size_t column) {
  Piece piece;
  piece.request.table = table;
  piece.columns = {column};
  return piece;
}

/// Stamps and what the format calls text one by one, all others as numbers together.
std::vector<Piece> pieces_of(const std::vector<TableInfo>& tables) {
  std::vector<Piece> pieces;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    Piece numbers;
    numbers.request.table = t;
    for (std::size_t c = 0; c < tables[t].columns.size(); ++c) {
      const ColumnInfo& column = tables[t].columns[c];
      if (column.type == "time") {
        Piece& stamps = pieces.emplace_back(one_column(t, c));
        stamps.request.time.column = column.name;
        stamps.request.time.may_miss = true;
      } else if (column.type == "text") {
        pieces.emplace_back(one_column(t, c)).request.text = column.name;
      } else {
        numbers.request.numbers.push_back(column.name);
        numbers.request.may_miss.push_back(true);
        numbers.columns.push_back(c);
      }
    }
    if (!numbers.columns.empty()) pieces.push_back(std::move(numbers));
  }
  return pieces;
}

/// Whether the file has what the pieces ask for; `result` has it then.
bool try_read(const TableReader& reader, const std::vector<Piece>& pieces, FileColumns& result) {
  std::vector<TableRequest> requests;
  for (const Piece& piece : pieces) requests.push_back(piece.request);
  try {
    InputFile unused;
    std::vector<Table> tables = reader.read(requests, unused);
    for (std::size_t i = 0; i < pieces.size(); ++i) pieces[i].into(std::move(tables[i]), result);
    return true;
  } catch (const DataError&) {
    return false;
  }
}

/// A piece whose numbers are not all numbers: column by column, as texts where they are none.
void read_apart(const TableReader& reader, const Piece& piece, FileColumns& result) {
  for (std::size_t i = 0; i < piece.request.numbers.size(); ++i) {
    Piece single = one_column(piece.request.table, piece.columns[i]);
    single.request.numbers = {piece.request.numbers[i]};
    single.request.may_miss = {true};
    if (try_read(reader, {single}, result)) continue;
    single.request.text = std::exchange(single.request.numbers, {}).front();
    try_read(reader, {single}, result);
  }
  const std::vector<FileColumn>& found = result[piece.request.table];
  const auto unread = [&](std::size_t column) { return std::holds_alternative<std::monostate>(found[column]); };
  if (!std::all_of(piece.columns.begin(), piece.columns.end(), unread)) return;
  InputFile unused;
  reader.read({piece.request}, unused);  // throws what is wrong with all of them
}

/// All columns, in one pass over the file where all are what the format says.
FileColumns read_columns(const TableReader& reader, const std::vector<TableInfo>& tables) {
  FileColumns result;
  for (const TableInfo& table : tables) result.emplace_back(table.columns.size());
  const std::vector<Piece> pieces = pieces_of(tables);
  if (try_read(reader, pieces, result)) return result;
  for (const Piece& piece : pieces)
    if (!try_read(reader, {piece}, result)) read_apart(reader, piece, result);
  return result;
}

py::object array_of(FileColumn&& column) {
  if (auto* numbers = std::get_if<std::vector<double>>(&column)) return copied(*numbers);
  if (auto* texts = std::get_if<std::vector<std::string>>(&column)) return py::cast(*texts);
  auto& stamps = std::get<std::vector<std::int64_t>>(column);
  return copied(stamps.data(), {std::ssize(stamps)}).attr("view")("datetime64[ns]");
}

/// {table: {column: values}} of any readable log.
py::dict read_log(const std::string& path, const py::dict& keys) {
  const app::Config config = config_of(keys, "data.");
  std::vector<TableInfo> tables;
  FileColumns columns;
  {
    const py::gil_scoped_release unlocked;
    const std::shared_ptr<const TableReader> reader = open_table(path, config.data.format);
    tables = reader->tables();
    columns = read_columns(*reader, tables);
  }
  py::dict result;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    py::dict table, units;
    for (std::size_t j = 0; j < tables[i].columns.size(); ++j) {
      if (std::holds_alternative<std::monostate>(columns[i][j])) continue;
      table[py::str(tables[i].columns[j].name)] = array_of(std::move(columns[i][j]));
      units[py::str(tables[i].columns[j].name)] = tables[i].columns[j].unit;
    }
    result[py::str(tables[i].name)] = py::make_tuple(table, units);
  }
  return result;
}

}  // namespace

MemoryTables memory_tables(const py::dict& tables) {
  MemoryTables result;
  for (const auto& [run, frames] : tables) {
    const std::string name = py::str(run);
    auto& readers = result[name];
    for (const py::handle frame : frames)
      readers.push_back(table_of(readers.empty() ? name : name + " (states)", frame.cast<py::dict>()));
  }
  return result;
}

void bind_tables(py::module_& module) { module.def("read_log", &read_log, py::arg("path"), py::arg("keys")); }

}  // namespace modebank::python
