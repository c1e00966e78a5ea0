#include "io/arrays/array_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <numeric>

#include "ident/base/not_a_number.hpp"
#include "io/arrays/stored_columns.hpp"
#include "io/table/name_unit.hpp"
#include "io/table/stamp_column.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

/// Columns that have the same rows, as indices in the store.
struct Block {
  std::string group;
  std::uint64_t rows = 0;
  bool timed = false;
  std::vector<std::size_t> columns;
};

std::vector<Block> blocks_of(const std::vector<StoredColumn>& columns) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const auto same = [&](const Block& b) { return b.group == columns[i].group && b.rows == columns[i].rows; };
    auto block = std::find_if(blocks.begin(), blocks.end(), same);
    if (block == blocks.end()) block = blocks.insert(blocks.end(), {columns[i].group, columns[i].rows, false, {}});
    block->columns.push_back(i);
    block->timed = block->timed || is_time(columns[i]);
  }
  return blocks;
}

bool is_above(const std::string& group, const std::string& below) {
  return group.empty() ? !below.empty() : below.starts_with(group + ".") || below.starts_with(group + "[");
}

/// A block without times joins the nearest enclosing group that has times of the block's length.
std::vector<Block> joined(const std::vector<Block>& blocks) {
  std::vector<Block> result;
  for (const Block& block : blocks)
    if (block.timed) result.push_back(block);
  for (const Block& block : blocks) {
    if (block.timed) continue;
    Block* nearest = nullptr;
    for (Block& above : result)
      if (above.timed && above.rows == block.rows && is_above(above.group, block.group) &&
          (nearest == nullptr || above.group.size() > nearest->group.size()))
        nearest = &above;
    if (nearest == nullptr)
      result.push_back(block);
    else
      nearest->columns.insert(nearest->columns.end(), block.columns.begin(), block.columns.end());
  }
  return result;
}

class ArrayReader : public TableReader {
 public:
  ArrayReader(const std::filesystem::path& path, std::unique_ptr<ColumnStore> store)
      : path_(path), store_(std::move(store)), blocks_(joined(blocks_of(store_->columns()))) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) tables_.push_back(table_of(b));
  }

  std::vector<TableInfo> tables() const override { return tables_; }

  std::vector<std::string> left_out() const override { return store_->left_out(); }
  std::string why_without(const std::string& column) const override { return store_->why_without(column); }

  InputFile describe(const std::vector<TableRequest>&) const override { return describe_file(path_); }

  std::vector<Table> read(const std::vector<TableRequest>& requests, InputFile* file) const override {
    if (file != nullptr) *file = describe(requests);
    std::vector<Table> result;
    for (const TableRequest& request : requests) result.push_back(read_table(request));
    return result;
  }

 private:
  std::filesystem::path path_;
  std::unique_ptr<ColumnStore> store_;
  std::vector<Block> blocks_;
  std::vector<TableInfo> tables_;

  /// A table has the name of its group. If columns of a group have several lengths, the group has several tables. All
  /// names but the first then include the length.
  TableInfo table_of(std::size_t b) const {
    const Block& block = blocks_[b];
    TableInfo table;
    table.name = block.group;
    for (std::size_t earlier = 0; earlier < b; ++earlier)
      if (blocks_[earlier].group == block.group) table.name = fmt::format("{}[{} rows]", block.group, block.rows);
    table.rows = block.rows;
    for (const std::size_t i : block.columns) {
      const StoredColumn& column = store_->columns()[i];
      table.columns.push_back({column.path(), column.unit, is_time(column) ? "time" : column.type});
    }
    return table;
  }

  std::vector<double> values_of(std::size_t column) const {
    const StoredColumn& stored = store_->columns()[column];
    std::vector<double> values(static_cast<std::size_t>(stored.rows));
    std::iota(values.begin(), values.end(), 0.0);
    if (!(stored.step_s > 0.0)) values = store_->numbers(column);
    for (double& value : values) value = value == stored.fill ? not_a_number : stored.scale * value + stored.offset;
    return values;
  }

  std::size_t stored(const TableRequest& request, const std::string& name) const {
    const TableInfo& table = tables_.at(request.table);
    return blocks_[request.table].columns[column_position(path_.string(), column_names(table), name)];
  }

  Table read_table(const TableRequest& request) const {
    Table table;
    for (std::size_t i = 0; i < request.numbers.size(); ++i)
      table.numbers.push_back(
          numbers(stored(request, request.numbers[i]), i < request.may_miss.size() && request.may_miss[i]));
    for (const std::string& name : request.texts) table.texts.push_back(texts(stored(request, name)));
    table.line.resize(static_cast<std::size_t>(tables_.at(request.table).rows));
    std::iota(table.line.begin(), table.line.end(), std::uint64_t{1});
    if (!request.time.column.empty()) times(request, table);
    note_unwritten(request, table);
    return table;
  }

  /// Adds one note for all columns that lack the same rows.
  void note_unwritten(const TableRequest& request, Table& table) const {
    std::vector<std::string> names = request.numbers;
    names.insert(names.end(), request.texts.begin(), request.texts.end());
    if (!request.time.column.empty()) names.push_back(request.time.column);
    std::map<std::string, std::vector<std::string>> by_rows;
    for (const std::string& name : names)
      if (const auto ranges = store_->unwritten(stored(request, name)); !ranges.empty())
        by_rows[rows_text(ranges)].push_back(name);
    for (const auto& [rows, columns] : by_rows)
      table.notes.push_back(fmt::format("{} of {} were never written, so they read as the file's fill value", rows,
                                        fmt::join(columns, ", ")));
  }

  std::vector<double> numbers(std::size_t column, bool may_miss) const {
    const StoredColumn& stored = store_->columns()[column];
    if (stored.text) throw DataError(fmt::format("{}: column {} is text, not numbers", path_.string(), stored.path()));
    std::vector<double> values = values_of(column);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (std::isfinite(values[k])) continue;
      if (!may_miss)
        throw DataError(fmt::format("{}:{}: column {}: missing value ({}){}", path_.string(), k + 1, stored.path(),
                                    values[k], unwritten_text(store_->unwritten(column), k + 1)));
      values[k] = not_a_number;
    }
    return values;
  }

  std::vector<std::string> texts(std::size_t column) const {
    const StoredColumn& stored = store_->columns()[column];
    if (stored.text) return store_->texts(column);
    std::vector<std::string> result;
    if (stored.whole)
      for (const std::int64_t value : store_->whole_numbers(column)) result.push_back(fmt::format("{}", value));
    else
      for (const double value : values_of(column)) result.push_back(fmt::format("{}", value));
    return result;
  }

  /// A time that was never written is read as NaN. Its row is removed if values may be missing.
  static void leave_out_untimed(const TableRequest& request, const std::vector<double>& times, Table& table) {
    const bool may_miss = std::find(request.may_miss.begin(), request.may_miss.end(), true) != request.may_miss.end();
    if (!may_miss || table.unwritten.empty() || times.empty()) return;
    std::vector<std::size_t> kept;
    for (std::size_t k = 0; k < times.size(); ++k)
      if (!std::isnan(times[k]) || range_of(table.unwritten, k + 1) == table.unwritten.end()) kept.push_back(k);
    const auto keep = [&kept](auto& column) {
      for (std::size_t i = 0; i < kept.size(); ++i) std::swap(column[i], column[kept[i]]);
      column.resize(kept.size());
    };
    for (std::vector<double>& column : table.numbers) keep(column);
    for (std::vector<std::string>& column : table.texts) keep(column);
    keep(table.line);
  }

  void times(const TableRequest& request, Table& table) const {
    const std::size_t column = stored(request, request.time.column);
    const StoredColumn& from = store_->columns()[column];
    table.unwritten = store_->unwritten(column);
    StampColumn stamps(request.time, from.unit);
    stamps.reserve(table.rows());
    const bool two = !request.time.second.empty();
    const std::vector<std::string> first = two || from.text ? texts(column) : std::vector<std::string>();
    const std::vector<std::string> second = two ? texts(stored(request, request.time.second)) : first;
    const std::vector<std::int64_t> whole = from.whole ? store_->whole_numbers(column) : std::vector<std::int64_t>();
    const std::vector<double> values = from.whole || from.text ? std::vector<double>() : values_of(column);
    if (!request.time.may_miss) leave_out_untimed(request, values, table);
    for (const std::uint64_t line : table.line) {
      const auto k = static_cast<std::size_t>(line - 1);
      const NumberStatus status = two          ? stamps.add(first[k], second[k])
                                  : from.text  ? stamps.add(first[k])
                                  : from.whole ? stamps.add(whole[k])
                                               : stamps.add(values[k]);
      if (status == NumberStatus::missing && request.time.may_miss)
        stamps.add_missing();
      else if (status != NumberStatus::ok)
        throw DataError(fmt::format("{}:{}: column {}: {}{}", path_.string(), k + 1, from.path(),
                                    stamps.complaint(status, !first.empty() ? first[k]
                                                             : from.whole   ? fmt::to_string(whole[k])
                                                                            : fmt::format("{}", values[k])),
                                    unwritten_text(table.unwritten, k + 1)));
    }
    stamps.finish(path_.string(), table);
  }
};

}  // namespace

bool is_mat(const std::filesystem::path& path, std::string_view first) {
  return first.starts_with("MATLAB 5.0 MAT-file") || path.extension() == ".mat";
}

bool is_time_name(std::string_view name) {
  name = split_unit(name).name;
  std::string lower(name.substr(name.rfind('.') + 1));
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array names{"t",   "time",    "tout",    "stamp",   "timestamp", "time_s",   "t_s",       "secs",
                             "sec", "seconds", "time_ns", "time_ms", "time_us",   "stamp_ns", "timestamps"};
  return std::find(names.begin(), names.end(), lower) != names.end();
}

std::shared_ptr<const TableReader> open_hdf5_tables(const std::filesystem::path& path) {
  return std::make_shared<ArrayReader>(path, open_hdf5_columns(path));
}

std::shared_ptr<const TableReader> open_mat_tables(const std::filesystem::path& path) {
  return std::make_shared<ArrayReader>(path, open_mat_columns(path));
}

}  // namespace modebank
