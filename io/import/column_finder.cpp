#include "io/import/column_finder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "ident/base/nearest_name.hpp"
#include "io/import/open_table.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Texts = std::vector<std::string>;

const ColumnInfo* find_column(const TableInfo& table, const std::string& name) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const ColumnInfo& column) { return column.name == name; });
  return found == table.columns.end() ? nullptr : &*found;
}

/// A column of the table by its full name, or by what follows the table's name in it.
const ColumnInfo* find_within(const TableInfo& table, const std::string& name) {
  if (const ColumnInfo* column = find_column(table, name)) return column;
  if (table.name.empty()) return nullptr;
  for (const char* separator : {".", "/"})
    if (const ColumnInfo* column = find_column(table, table.name + separator + name)) return column;
  return nullptr;
}

/// The stamps that a table of a recording has: its messages' header's, else when they were received, else its first.
const ColumnInfo* own_stamps(const TableInfo& table) {
  for (const char* name : {"header.stamp", "receive_time"})
    if (const ColumnInfo* column = find_within(table, name)) return column;
  const auto stamps = std::find_if(table.columns.begin(), table.columns.end(),
                                   [](const ColumnInfo& column) { return column.type == "time"; });
  return stamps == table.columns.end() ? nullptr : &*stamps;
}

const ColumnInfo* find_time(const TableInfo& table, const DataOptions& options) {
  if (const ColumnInfo* column = find_within(table, options.time.front())) return column;
  return options.time == DataOptions().time ? own_stamps(table) : nullptr;
}

/// What a file has: its columns, or where they are too many to read through its tables.
std::string listing(const std::vector<TableInfo>& tables) {
  constexpr std::size_t most_columns = 100;
  Texts columns, names;
  for (const TableInfo& table : tables) {
    names.push_back(table.type.empty() ? table.name : fmt::format("{} ({})", table.name, table.type));
    for (const ColumnInfo& column : table.columns) columns.push_back(column.name);
  }
  if (columns.size() == 1 && columns.front().find_first_of(",;|\t ") != std::string::npos)
    return columns.front() + " (a single one: data.separator says what separates)";
  if (columns.size() <= most_columns || tables.size() == 1) return fmt::format("{}", fmt::join(columns, ", "));
  return fmt::format("{} in the tables {}", columns.size(), fmt::join(names, ", "));
}

}  // namespace

ColumnFinder::ColumnFinder(FilePlan& plan, const FormatOptions& options) : plan_(plan) {
  for (const auto& path : plan.paths) {
    plan.readers.push_back(open_table(path, options));
    names_.push_back(path.string());
    tables_.push_back(plan.readers.back()->tables());
  }
}

const TableInfo& ColumnFinder::table_of(std::size_t source) const {
  return tables_[plan_.sources[source].path][plan_.sources[source].request.table];
}

std::size_t ColumnFinder::source_of(std::size_t file, std::size_t table) {
  for (std::size_t source = 0; source < plan_.sources.size(); ++source)
    if (plan_.sources[source].path == file && plan_.sources[source].request.table == table) return source;
  SourcePlan& added = plan_.sources.emplace_back();
  added.path = file;
  added.request.table = table;
  return plan_.sources.size() - 1;
}

void ColumnFinder::fail(const std::string& column, const std::vector<std::size_t>& files) const {
  Texts all;
  std::string each;
  for (const std::size_t file : files) {
    each += fmt::format("; {} has {}", names_[file], listing(tables_[file]));
    for (const TableInfo& table : tables_[file])
      for (const ColumnInfo& known : table.columns) all.push_back(known.name);
  }
  const std::string meant = did_you_mean(column, all);
  if (files.size() > 1) throw ConfigurationError(fmt::format("no column \"{}\"{}{}", column, meant, each));
  throw ConfigurationError(fmt::format("{} has no column \"{}\"{}; columns: {}", names_[files.front()], column, meant,
                                       listing(tables_[files.front()])));
}

std::size_t ColumnFinder::source_with(const std::string& column, const std::vector<std::size_t>& files) {
  for (const std::size_t file : files)
    for (std::size_t table = 0; table < tables_[file].size(); ++table)
      if (find_column(tables_[file][table], column) != nullptr) {
        column_position(names_[file], column_names(tables_[file][table]), column);  // throws where it is there twice
        return source_of(file, table);
      }
  fail(column, files);
}

ColumnRef ColumnFinder::number(const std::string& column, const std::vector<std::size_t>& files) {
  const std::size_t source = source_with(column, files);
  Texts& requested = plan_.sources[source].request.numbers;
  const auto found = std::find(requested.begin(), requested.end(), column);
  const auto position = static_cast<std::size_t>(found - requested.begin());
  if (found == requested.end()) requested.push_back(column);
  return {source, position};
}

std::vector<ColumnRef> ColumnFinder::numbers(const Texts& columns, const std::vector<std::size_t>& files) {
  std::vector<ColumnRef> found;
  for (const std::string& column : columns) found.push_back(number(column, files));
  return found;
}

std::size_t ColumnFinder::source_without_column(std::size_t file, std::size_t states) {
  if (plan_.sources[states].path == file) return states;
  if (tables_[file].size() > 1)
    throw ConfigurationError(fmt::format("{} has several tables: data.input says which is meant", names_[file]));
  return source_of(file, 0);
}

std::size_t ColumnFinder::first_with_time(const std::vector<std::size_t>& sources, const DataOptions& options) const {
  for (const std::size_t source : sources)
    if (options.time.empty() || find_time(table_of(source), options) != nullptr) return source;
  std::vector<std::size_t> files;
  for (const std::size_t source : sources)
    if (std::find(files.begin(), files.end(), plan_.sources[source].path) == files.end())
      files.push_back(plan_.sources[source].path);
  fail(options.time.front(), files);
}

std::size_t ColumnFinder::first_with(const std::string& column, const std::vector<std::size_t>& sources) const {
  std::vector<std::size_t> files;
  for (const std::size_t source : sources) {
    if (find_within(table_of(source), column) != nullptr) return source;
    files.push_back(plan_.sources[source].path);
  }
  fail(column, files);
}

void ColumnFinder::time(std::size_t source, const DataOptions& options) {
  if (options.time.empty()) return;
  const TableInfo& table = table_of(source);
  TimeRequest& request = plan_.sources[source].request.time;
  const ColumnInfo* column = find_time(table, options);
  if (column == nullptr) fail(options.time.front(), {plan_.sources[source].path});
  column_position(path_of(source), column_names(table), column->name);  // throws where it is there twice
  request.column = column->name;
  request.unit = options.time_unit;
  if (options.time.size() < 2) return;
  const ColumnInfo* nanoseconds = find_within(table, options.time[1]);
  if (nanoseconds == nullptr) fail(options.time[1], {plan_.sources[source].path});
  request.nanoseconds = nanoseconds->name;
}

void ColumnFinder::text(std::size_t source, const std::string& column) {
  if (column.empty()) return;
  const ColumnInfo* found = find_within(table_of(source), column);
  if (found == nullptr) fail(column, {plan_.sources[source].path});
  column_position(path_of(source), column_names(table_of(source)), found->name);
  plan_.sources[source].request.text = found->name;
}

std::vector<Channel> ColumnFinder::channels(const std::vector<ColumnRef>& refs) const {
  std::vector<Channel> channels;
  for (const ColumnRef ref : refs) {
    const std::string& name = plan_.sources[ref.source].request.numbers[ref.column];
    channels.push_back({name, find_column(table_of(ref.source), name)->unit});
  }
  return channels;
}

}  // namespace modebank
