#include "io/hdf5/table.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <type_traits>

#include "modebank/base/error.hpp"

namespace modebank::hdf5 {

namespace {

template <class T>
using Vector = std::vector<T>;

template <class T>
Handle copy_type(hid_t type) {
  return {H5Tcopy(type), H5Tclose, "copy a number type"};
}

Handle array_type(hid_t element, hsize_t length) {
  return {H5Tarray_create2(element, 1, &length), H5Tclose, "make an array type"};
}

/// HDF5 has no array type of length 0, so the array column of an empty table has length 1.
hsize_t array_length(const Eigen::MatrixXd& values) {
  return static_cast<hsize_t>(std::max<Eigen::Index>(values.rows(), 1));
}

/// The types of a column's cell: in the file, and in memory if values are contiguous.
struct CellTypes {
  Handle file;
  Handle memory;
};

template <class T>
CellTypes cell_types(const Vector<T>&) {
  return {copy_type<T>(file_type<T>()), copy_type<T>(memory_type<T>())};
}
CellTypes cell_types(const Vector<std::string>& values) {
  return {string_type(longest(values)), string_type(longest(values))};
}
CellTypes cell_types(const Eigen::MatrixXd& values) {
  return {array_type(H5T_IEEE_F64LE, array_length(values)), array_type(H5T_NATIVE_DOUBLE, array_length(values))};
}

/// Type of a row with contiguous members. Numbers have equal sizes in memory and in the file.
Handle row_type(const std::vector<TableColumn>& columns, const std::vector<CellTypes>& cells,
                Handle CellTypes::*where) {
  std::size_t bytes = 0;
  for (const CellTypes& cell : cells) bytes += H5Tget_size((cell.*where).id());
  Handle type(H5Tcreate(H5T_COMPOUND, bytes), H5Tclose, "make a table type");
  std::size_t offset = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const hid_t cell = (cells[i].*where).id();
    check(H5Tinsert(type.id(), columns[i].name.c_str(), offset, cell), "add the column '" + columns[i].name + "'");
    offset += H5Tget_size(cell);
  }
  return type;
}

template <class T>
std::string raw_bytes(const Vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string raw_bytes(const Vector<std::string>& values) { return pack_texts(values, longest(values)); }
std::string raw_bytes(const Eigen::MatrixXd& values) {
  return {reinterpret_cast<const char*>(values.data()), static_cast<std::size_t>(values.size()) * sizeof(double)};
}

/// The contiguous cells of a column, as they are in the file.
struct StoredColumn {
  Handle type;
  std::size_t cell_bytes = 0;
  std::string cells;
};

/// The cells of a member, after a check of their type. Rows are read once for all columns. If members were read one by
/// one, HDF5 would allocate and clear a megabyte for each.
StoredColumn stored_column(const TableRows& all, const std::string& name, H5T_class_t expected) {
  const StoredArray& table = all.table;
  const int index = H5Tget_member_index(table.type(), name.c_str());
  if (index < 0) throw DataError("column '" + name + "' is missing");
  const auto member = static_cast<unsigned>(index);
  if (H5Tget_member_class(table.type(), member) != expected)
    throw DataError("column '" + name + "' has values of another type");
  StoredColumn column{
      {H5Tget_member_type(table.type(), member), H5Tclose, "read the type of column '" + name + "'"}, 0, {}};
  column.cell_bytes = H5Tget_size(column.type.id());
  const std::size_t row_bytes = H5Tget_size(table.type()), offset = H5Tget_member_offset(table.type(), member);
  const auto rows = static_cast<std::size_t>(all.rows.count);
  column.cells.resize(rows * column.cell_bytes);
  for (std::size_t row = 0; row < rows; ++row)
    all.bytes.copy(column.cells.data() + row * column.cell_bytes, column.cell_bytes, row * row_bytes + offset);
  return column;
}

/// Converts `count` cells from the stored type to another type of the same size.
const std::string& converted(StoredColumn& column, hid_t stored, hid_t wanted, std::size_t count) {
  if (H5Tequal(stored, wanted) <= 0)
    check(H5Tconvert(stored, wanted, count, column.cells.data(), nullptr, H5P_DEFAULT), "convert a column");
  return column.cells;
}

template <class T>
void read_values(const TableRows& rows, const std::string& name, Vector<T>& values) {
  StoredColumn stored = stored_column(rows, name, std::is_floating_point_v<T> ? H5T_FLOAT : H5T_INTEGER);
  // If a smaller number were accepted, a small file could require much memory.
  if (stored.cell_bytes != sizeof(T)) throw DataError("column '" + name + "' has numbers of another width");
  values.resize(static_cast<std::size_t>(rows.rows.count));
  const std::string& cells = converted(stored, stored.type.id(), memory_type<T>(), values.size());
  std::copy_n(cells.data(), cells.size(), reinterpret_cast<char*>(values.data()));
}

void read_values(const TableRows& rows, const std::string& name, Vector<std::string>& values) {
  StoredColumn stored = stored_column(rows, name, H5T_STRING);
  const Handle padded(H5Tcopy(stored.type.id()), H5Tclose, "copy a string type");
  check(H5Tset_strpad(padded.id(), H5T_STR_NULLPAD), "pad a string type");
  values = unpack_texts(converted(stored, stored.type.id(), padded.id(), static_cast<std::size_t>(rows.rows.count)),
                        stored.cell_bytes);
}

void read_values(const TableRows& rows, const std::string& name, Eigen::MatrixXd& values) {
  StoredColumn stored = stored_column(rows, name, H5T_ARRAY);
  const Handle element(H5Tget_super(stored.type.id()), H5Tclose, "read an array type");
  hsize_t length = 0;
  if (H5Tget_array_ndims(stored.type.id()) != 1 || H5Tget_class(element.id()) != H5T_FLOAT)
    throw DataError("column '" + name + "' does not have arrays of numbers");
  check(H5Tget_array_dims2(stored.type.id(), &length), "read an array type");
  if (H5Tget_size(element.id()) != sizeof(double) || length != stored.cell_bytes / sizeof(double))
    throw DataError("column '" + name + "' has numbers of another width");
  values.resize(static_cast<Eigen::Index>(length), static_cast<Eigen::Index>(rows.rows.count));
  const std::string& cells =
      converted(stored, element.id(), H5T_NATIVE_DOUBLE, static_cast<std::size_t>(values.size()));
  std::copy_n(cells.data(), cells.size(), reinterpret_cast<char*>(values.data()));
}

template <class T>
void append_values(Vector<T>& more, Vector<T>& values) {
  values.insert(values.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void append_values(const Eigen::MatrixXd& more, Eigen::MatrixXd& values) {
  if (more.cols() == 0) return;
  if (values.cols() > 0 && values.rows() != more.rows()) throw std::invalid_argument("lengths of a column differ");
  values.conservativeResize(more.rows(), values.cols() + more.cols());
  values.rightCols(more.cols()) = more;
}

}  // namespace

void append(std::vector<TableColumn> more, std::vector<TableColumn>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    std::visit(
        [&](auto& values) { append_values(std::get<std::decay_t<decltype(values)>>(more.at(i).values), values); },
        columns[i].values);
}

Handle write_table(hid_t group, const std::string& name, std::vector<TableColumn> columns, hsize_t rows) {
  std::vector<CellTypes> cells;
  for (const TableColumn& column : columns)
    cells.push_back(std::visit([](const auto& values) { return cell_types(values); }, column.values));
  const Handle type = row_type(columns, cells, &CellTypes::file),
               in_memory = row_type(columns, cells, &CellTypes::memory);
  const std::size_t row_bytes = H5Tget_size(in_memory.id());
  // Writes whole rows. If members were written one by one, HDF5 would allocate and clear a megabyte for each.
  std::string packed(static_cast<std::size_t>(rows) * row_bytes, '\0');
  std::size_t offset = 0;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string bytes = std::visit([](const auto& values) { return raw_bytes(values); }, columns[i].values);
    const std::size_t size = H5Tget_size(cells[i].memory.id());
    columns[i].values = {};
    for (std::size_t row = 0; row < rows; ++row) bytes.copy(packed.data() + row * row_bytes + offset, size, row * size);
    offset += size;
  }
  return write_array(group, Place::dataset, name, type.id(), in_memory.id(), {rows}, packed.data());
}

bool has_column(const StoredArray& table, const std::string& name) {
  return table.type_class() == H5T_COMPOUND && H5Tget_member_index(table.type(), name.c_str()) >= 0;
}

TableRows read_rows(const StoredArray& table, const Rows& rows) {
  if (table.type_class() != H5T_COMPOUND || table.shape().size() != 1) throw DataError("it is not a table");
  return {table, rows, table.row_bytes(rows)};
}

TableRows read_all_rows(const StoredArray& table) { return read_rows(table, {0, table.elements()}); }

void read_column(const TableRows& rows, TableColumn& column) {
  std::visit([&](auto& values) { read_values(rows, column.name, values); }, column.values);
}

}  // namespace modebank::hdf5
