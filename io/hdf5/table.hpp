#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "io/hdf5/array.hpp"

namespace modebank::hdf5 {

/// One column of a compound table. A matrix is an array column, and each of the matrix' columns belongs to one row of
/// the table.
struct TableColumn {
  using Values =
      std::variant<std::vector<std::int8_t>, std::vector<std::int32_t>, std::vector<std::int64_t>,
                   std::vector<std::uint64_t>, std::vector<double>, std::vector<std::string>, Eigen::MatrixXd>;
  std::string name;
  Values values;
};

/// Appends the values of other columns, which have the same names and types.
void append(std::vector<TableColumn> more, std::vector<TableColumn>& columns);

/// Writes a 1-D compound dataset of `rows` packed rows. Returns it open. Each column is freed when it has been packed,
/// so a long table is never in memory twice.
Handle write_table(hid_t group, const std::string& name, std::vector<TableColumn> columns, hsize_t rows);

/// Whether a compound dataset has a member of that name.
bool has_column(const StoredArray& table, const std::string& name);

/// Rows of a table as they are in the file. They are read once for all columns.
struct TableRows {
  const StoredArray& table;
  Rows rows;
  std::string bytes;
};
/// Throws DataError if the dataset is not a table.
TableRows read_rows(const StoredArray& table, const Rows& rows);
TableRows read_all_rows(const StoredArray& table);

/// Fills `column.values` from the member with the column's name. The type that the variant holds is the expected type.
/// Throws DataError if the member is missing or has another type. Other members are ignored.
void read_column(const TableRows& rows, TableColumn& column);

}  // namespace modebank::hdf5
