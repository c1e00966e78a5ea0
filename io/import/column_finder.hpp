#pragma once

#include <string>
#include <vector>

#include "io/import/import_plan.hpp"

namespace modebank {

/// Finds columns in the tables of a plan's files and adds them to the requests of its sources. Throws
/// ConfigurationError with the existing names if a column does not exist.
class ColumnFinder {
 public:
  /// The readers of `plan` must be open.
  ColumnFinder(FilePlan& plan, std::shared_ptr<const DerivedChannels> derived);

  /// A column of numbers: a derived channel, or a column of the first of `files` (indices in FilePlan::paths) that has
  /// this column. A derived channel may also use other files.
  ColumnRef number(const std::string& column, const std::vector<std::size_t>& files);
  std::vector<ColumnRef> numbers(const std::vector<std::string>& columns, const std::vector<std::size_t>& files);

  /// The column of data.where.
  ColumnRef where(const std::vector<std::size_t>& files);
  /// A source of the column.
  std::size_t clock_of(ColumnRef ref) const;

  /// The source for a file of which only times are needed: its only table, or `states` if that is in the same file.
  std::size_t source_without_column(std::size_t file, std::size_t states);

  /// The first of `sources` whose table has the times, or the column.
  std::size_t first_with_time(const std::vector<std::size_t>& sources, const DataOptions& options) const;
  std::size_t first_with(const std::string& column, const std::vector<std::size_t>& sources) const;

  /// Requests times of a source.
  void time(std::size_t source, const DataOptions& options);
  /// Requests a column of text; returns its index in the request.
  std::size_t text(std::size_t source, const std::string& column);

  /// The source with the column, from the first of `files` that has it.
  std::size_t source_with(const std::string& column, const std::vector<std::size_t>& files);

  /// Names and units of the columns.
  std::vector<Channel> channels(const std::vector<ColumnRef>& refs) const;

 private:
  const TableInfo& table_of(std::size_t source) const;
  const std::string& path_of(std::size_t source) const { return names_[plan_.sources[source].path]; }
  std::size_t source_of(std::size_t file, std::size_t table);
  ColumnRef derive(const DerivedChannel& channel, const std::vector<std::size_t>& files);
  ColumnRef derived_of_table(std::shared_ptr<const DerivedChannel> channel, std::size_t source,
                             const std::vector<ColumnRef>& operands);
  [[noreturn]] void fail(const std::string& column, const std::vector<std::size_t>& files) const;

  FilePlan& plan_;
  std::shared_ptr<const DerivedChannels> derived_;
  std::vector<std::string> names_;              // names of the files
  std::vector<std::vector<TableInfo>> tables_;  // tables of each file
};

}  // namespace modebank
