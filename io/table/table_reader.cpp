#include "io/table/table_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

std::string rows_text(const std::vector<LineRange>& ranges) {
  std::string text = fmt::format("rows {} to {}", ranges.front().first, ranges.front().last);
  if (ranges.size() > 1) text += fmt::format(" and {} more ranges", ranges.size() - 1);
  return text;
}

std::vector<LineRange>::const_iterator range_of(const std::vector<LineRange>& ranges, std::uint64_t line) {
  return std::find_if(ranges.begin(), ranges.end(),
                      [line](const LineRange& range) { return range.first <= line && line <= range.last; });
}

std::string unwritten_text(const std::vector<LineRange>& ranges, std::uint64_t line) {
  const auto found = range_of(ranges, line);
  return found == ranges.end() ? std::string() : fmt::format("; {} were never written", rows_text({*found}));
}

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
