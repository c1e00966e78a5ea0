#pragma once

#include <string>
#include <vector>

#include "io/import/import_plan.hpp"

namespace modebank {

/// Looks columns up in the tables of one plan's files and notes them in its sources' requests. Throws
/// ConfigurationError for what is not there, naming what is.
class ColumnFinder {
 public:
  /// The plan has its readers.
  ColumnFinder(FilePlan& plan, std::shared_ptr<const DerivedChannels> derived);

  /// A column of numbers, derived or of the first of `files` (positions in FilePlan::paths) that has it; what is
  /// derived may use other files, too.
  ColumnRef number(const std::string& column, const std::vector<std::size_t>& files);
  std::vector<ColumnRef> numbers(const std::vector<std::string>& columns, const std::vector<std::size_t>& files);

  /// data.where.
  ColumnRef where(const std::vector<std::size_t>& files);
  /// A source that it comes from.
  std::size_t clock_of(ColumnRef ref) const;

  /// The source that stands for a file nothing but times is wanted of: its one table, or `states` where that is of the
  /// same file.
  std::size_t source_without_column(std::size_t file, std::size_t states);

  /// The first of `sources` whose table has the times, or the column.
  std::size_t first_with_time(const std::vector<std::size_t>& sources, const DataOptions& options) const;
  std::size_t first_with(const std::string& column, const std::vector<std::size_t>& sources) const;

  /// Requests times of a source.
  void time(std::size_t source, const DataOptions& options);
  /// Requests a column of text; its position in the request.
  std::size_t text(std::size_t source, const std::string& column);

  /// The source whose table has the column; the first of `files` that has it.
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
  std::vector<std::string> names_;              // of the files
  std::vector<std::vector<TableInfo>> tables_;  // of each file
};

}  // namespace modebank
