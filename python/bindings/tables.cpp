#include "python/bindings/tables.hpp"

#include <pybind11/stl.h>

#include <utility>
#include <variant>

#include "io/import/open_table.hpp"
#include "io/import/read_columns.hpp"
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

py::object array_of(FileColumn&& column) {
  if (auto* numbers = std::get_if<std::vector<double>>(&column)) return copied(*numbers);
  if (auto* texts = std::get_if<std::vector<std::string>>(&column)) return py::cast(*texts);
  auto& stamps = std::get<std::vector<std::int64_t>>(column);
  return copied(stamps.data(), {std::ssize(stamps)}).attr("view")("datetime64[ns]");
}

/// The tables of any readable log, as {table: ({column: values}, {column: unit})}. Returns only the tables and columns
/// in `chosen`, or all if `chosen` is empty.
py::dict read_log(const std::string& path, const std::vector<std::string>& chosen, const py::dict& keys) {
  const app::Config config = config_of(keys, "data.");
  std::vector<TableInfo> tables;
  std::vector<std::vector<FileColumn>> columns;
  {
    const py::gil_scoped_release unlocked;
    const std::shared_ptr<const TableReader> reader = open_table(path, config.data.format);
    tables = reader->tables();
    columns = read_columns(*reader, tables, choice_of(path, tables, chosen)).tables;
  }
  py::dict result;
  for (std::size_t i = 0; i < tables.size(); ++i) {
    py::dict table, units;
    for (std::size_t j = 0; j < tables[i].columns.size(); ++j) {
      if (std::holds_alternative<std::monostate>(columns[i][j])) continue;
      table[py::str(tables[i].columns[j].name)] = array_of(std::move(columns[i][j]));
      units[py::str(tables[i].columns[j].name)] = tables[i].columns[j].unit;
    }
    if (!chosen.empty() && table.empty()) continue;
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

void bind_tables(py::module_& module) {
  module.def("read_log", &read_log, py::arg("path"), py::arg("columns"), py::arg("keys"));
}

}  // namespace modebank::python
