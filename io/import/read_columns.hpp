#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// One column of a file. It contains numbers (NaN: missing), stamps as nanoseconds since 1970 (missing_stamp: missing),
/// or texts. Empty if the column was not requested or cannot be read.
using FileColumn =
    std::variant<std::monostate, std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;

struct FileColumns {
  std::vector<std::vector<FileColumn>> tables;  ///< the columns of each table
  std::vector<std::string> alternation;         ///< Table::alternation of each table
  std::vector<std::string> notes;               ///< remarks of the reader
};

using ColumnChoice = std::function<bool(const TableInfo& table, const ColumnInfo& column)>;

/// The columns chosen by their names or by the names of their tables. If no names are given, all columns. Throws
/// ConfigurationError, with `file`, if a name is unknown.
ColumnChoice choice_of(const std::string& file, const std::vector<TableInfo>& tables,
                       const std::vector<std::string>& chosen);

/// Reads the columns of `tables` that `wanted` chooses. One pass is enough if all columns have the types that the
/// format states. If a table has no readable column, throws the same exceptions as TableReader::read.
FileColumns read_columns(const TableReader& reader, const std::vector<TableInfo>& tables, const ColumnChoice& wanted);

}  // namespace modebank
