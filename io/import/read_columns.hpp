#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// One column of a file, whatever it holds: numbers (NaN where one is missing), stamps as nanoseconds since 1970
/// (missing_stamp where one is missing), else texts; nothing where it was not asked for or cannot be read.
using FileColumn =
    std::variant<std::monostate, std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>>;

struct FileColumns {
  std::vector<std::vector<FileColumn>> tables;  ///< of each table each column
  std::vector<std::string> alternation;         ///< of each table: Table::alternation
  std::vector<std::string> notes;               ///< of the reader
};

using ColumnChoice = std::function<bool(const TableInfo& table, const ColumnInfo& column)>;

/// Columns by their names, or all of the tables of that name; no names: all. Throws ConfigurationError, naming `file`,
/// for a name that there is not.
ColumnChoice choice_of(const std::string& file, const std::vector<TableInfo>& tables,
                       const std::vector<std::string>& chosen);

/// The columns that `wanted` chooses of a reader's `tables`, in one pass over the file where all are what the format
/// says they are. Throws what TableReader::read throws for a table of which no wanted column can be read.
FileColumns read_columns(const TableReader& reader, const std::vector<TableInfo>& tables, const ColumnChoice& wanted);

}  // namespace modebank
