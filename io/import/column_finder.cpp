#include "io/import/column_finder.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using Texts = std::vector<std::string>;

const ColumnInfo* find_column(const TableInfo& table, const std::string& name) {
  const auto found = std::find_if(table.columns.begin(), table.columns.end(),
                                  [&](const ColumnInfo& column) { return column.name == name; });
  return found == table.columns.end() ? nullptr : &*found;
}

/// Finds a column by its full name, or by the part of the full name that follows the table's name.
const ColumnInfo* find_within(const TableInfo& table, const std::string& name) {
  if (const ColumnInfo* column = find_column(table, name)) return column;
  if (table.name.empty()) return nullptr;
  for (const char* separator : {".", "/"})
    if (const ColumnInfo* column = find_column(table, table.name + separator + name)) return column;
  return nullptr;
}

/// The column of stamps in a recording's table. The header's stamps come first, then the receive times, then the first
/// other stamps.
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

/// The time column of this table ("log.cmd.t"), if the configuration names another table's time column ("log.imu.t").
const ColumnInfo* find_time_of_another(const TableInfo& table, const std::vector<TableInfo>& tables,
                                       const std::string& name) {
  for (const TableInfo& other : tables)
    if (!other.name.empty() && name.size() > other.name.size() + 1 && find_column(other, name) != nullptr &&
        name.starts_with(other.name))
      return find_within(table, name.substr(other.name.size() + 1));
  return nullptr;
}

/// Lists the columns of a file for messages. If there are too many, lists only the tables.
std::string listing(const std::vector<TableInfo>& tables) {
  constexpr std::size_t most_columns = 100;
  Texts columns, names;
  for (const TableInfo& table : tables) {
    names.push_back(table.type.empty() ? table.name : fmt::format("{} ({})", table.name, table.type));
    for (const ColumnInfo& column : table.columns) columns.push_back(column.name);
  }
  if (columns.size() == 1 && columns.front().find_first_of(",;|\t ") != std::string::npos)
    return columns.front() + " (a single one; set data.separator if its fields are separated by another character)";
  if (columns.size() <= most_columns || tables.size() == 1) return fmt::format("{}", fmt::join(columns, ", "));
  return fmt::format("{} in the tables {}", columns.size(), fmt::join(names, ", "));
}

}  // namespace

ColumnFinder::ColumnFinder(FilePlan& plan, std::shared_ptr<const DerivedChannels> derived)
    : plan_(plan), derived_(std::move(derived)) {
  for (std::size_t i = 0; i < plan.paths.size(); ++i) {
    names_.push_back(plan.paths[i].string());
    tables_.push_back(plan.readers[i]->tables());
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
  std::string each, left_out;
  for (const std::size_t file : files) {
    if (const std::string why = plan_.readers[file]->why_without(column); !why.empty())
      throw ConfigurationError(fmt::format("{} has no column \"{}\": {}", names_[file], column, why));
    each += fmt::format("; {} has {}", names_[file], listing(tables_[file]));
    for (const std::string& line : plan_.readers[file]->left_out()) left_out += "; " + line;
    for (const TableInfo& table : tables_[file])
      for (const ColumnInfo& known : table.columns) all.push_back(known.name);
  }
  for (const std::string& known : derived_->names()) all.push_back(known);
  const std::string meant = did_you_mean(column, all);
  if (files.size() > 1)
    throw ConfigurationError(printable_name(fmt::format("no column \"{}\"{}{}{}", column, meant, each, left_out)));
  throw ConfigurationError(printable_name(fmt::format("{} has no column \"{}\"{}; columns: {}{}", names_[files.front()],
                                                      column, meant, listing(tables_[files.front()]), left_out)));
}

std::size_t ColumnFinder::source_with(const std::string& column, const std::vector<std::size_t>& files) {
  for (const std::size_t file : files)
    for (std::size_t table = 0; table < tables_[file].size(); ++table)
      if (find_column(tables_[file][table], column) != nullptr) {
        column_position(names_[file], column_names(tables_[file][table]), column);  // throws if the name is repeated
        return source_of(file, table);
      }
  fail(column, files);
}

ColumnRef ColumnFinder::number(const std::string& column, const std::vector<std::size_t>& files) {
  if (const DerivedChannel* derived = derived_->find(column)) return derive(*derived, files);
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

ColumnRef ColumnFinder::where(const std::vector<std::size_t>& files) { return derive(*derived_->where(), files); }

std::size_t ColumnFinder::clock_of(ColumnRef ref) const {
  return ref.source == joint_source ? clock_of(plan_.joint[ref.column].operands.front()) : ref.source;
}

ColumnRef ColumnFinder::derive(const DerivedChannel& channel, const std::vector<std::size_t>& files) {
  const std::string& key = channel.expression.key();
  std::vector<std::size_t> all = files;
  for (std::size_t file = 0; file < names_.size(); ++file) {
    if (std::find(all.begin(), all.end(), file) == all.end()) all.push_back(file);
    for (const TableInfo& table : tables_[file])
      if (!channel.name.empty() && find_column(table, channel.name) != nullptr)
        throw ConfigurationError(
            fmt::format("{}: {} already has a column of that name; choose another name", key, names_[file]));
  }
  if (channel.expression.channels().empty()) throw ConfigurationError(fmt::format("{}: no channel is named", key));
  std::vector<ColumnRef> operands;
  try {
    operands = numbers(channel.expression.channels(), all);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(fmt::format("{}: {}", key, error.what()));
  }
  const std::size_t source = operands.front().source;
  const auto shared = std::make_shared<const DerivedChannel>(channel);
  if (source != joint_source &&
      std::all_of(operands.begin(), operands.end(), [source](const ColumnRef ref) { return ref.source == source; }))
    return derived_of_table(shared, source, operands);
  for (std::size_t i = 0; i < plan_.joint.size(); ++i)
    if (plan_.joint[i].channel->name == channel.name) return {joint_source, i};
  plan_.joint.push_back({shared, operands});
  return {joint_source, plan_.joint.size() - 1};
}

ColumnRef ColumnFinder::derived_of_table(std::shared_ptr<const DerivedChannel> channel, std::size_t source,
                                         const std::vector<ColumnRef>& operands) {
  SourcePlan& plan = plan_.sources[source];
  for (const DerivedColumn& known : plan.derived)
    if (known.channel->name == channel->name) return {source, known.position};
  DerivedColumn column{plan.request.numbers.size(), std::move(channel), {}};
  for (const ColumnRef operand : operands) column.operands.push_back(operand.column);
  plan.request.numbers.push_back(column.channel->name);
  plan.derived.push_back(column);
  return {source, column.position};
}

std::size_t ColumnFinder::source_without_column(std::size_t file, std::size_t states) {
  if (plan_.sources[states].path == file) return states;
  if (tables_[file].size() > 1)
    throw ConfigurationError(fmt::format("{} has several tables; name one of its columns in data.input", names_[file]));
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
  if (column == nullptr)
    column = find_time_of_another(table, tables_[plan_.sources[source].path], options.time.front());
  if (column == nullptr) fail(options.time.front(), {plan_.sources[source].path});
  column_position(path_of(source), column_names(table), column->name);  // throws if two columns have this name
  request.column = column->name;
  request.unit = options.time_unit;
  request.format = options.time_format;
  if (options.time.size() < 2) return;
  const ColumnInfo* second = find_within(table, options.time[1]);
  if (second == nullptr) fail(options.time[1], {plan_.sources[source].path});
  request.second = second->name;
}

std::size_t ColumnFinder::text(std::size_t source, const std::string& column) {
  const ColumnInfo* found = find_within(table_of(source), column);
  if (found == nullptr) fail(column, {plan_.sources[source].path});
  column_position(path_of(source), column_names(table_of(source)), found->name);
  std::vector<std::string>& texts = plan_.sources[source].request.texts;
  const auto known = std::find(texts.begin(), texts.end(), found->name);
  if (known != texts.end()) return static_cast<std::size_t>(known - texts.begin());
  texts.push_back(found->name);
  return texts.size() - 1;
}

std::vector<Channel> ColumnFinder::channels(const std::vector<ColumnRef>& refs) const {
  std::vector<Channel> channels;
  for (const ColumnRef ref : refs) {
    const auto* computed = ref.source == joint_source ? plan_.joint[ref.column].channel.get() : nullptr;
    if (computed == nullptr) computed = derived_->find(plan_.sources[ref.source].request.numbers[ref.column]);
    if (computed != nullptr) {
      channels.push_back({computed->name, computed->unit});
      continue;
    }
    const std::string& name = plan_.sources[ref.source].request.numbers[ref.column];
    channels.push_back({name, find_column(table_of(ref.source), name)->unit});
  }
  return channels;
}

}  // namespace modebank
