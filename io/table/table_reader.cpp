#include "io/table/table_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

std::vector<std::string> column_names(const TableInfo& table) {
  std::vector<std::string> names;
  for (const ColumnInfo& column : table.columns) names.push_back(column.name);
  return names;
}

std::size_t column_position(std::string_view file, const std::vector<std::string>& columns, const std::string& column) {
  const auto found = std::find(columns.begin(), columns.end(), column);
  if (found == columns.end())
    throw ConfigurationError(printable_name(fmt::format("{} has no column \"{}\"{}; columns: {}", file, column,
                                                        did_you_mean(column, columns), fmt::join(columns, ", "))));
  if (std::find(found + 1, columns.end(), column) != columns.end())
    throw ConfigurationError(fmt::format("{} has column \"{}\" twice", file, column));
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace modebank
