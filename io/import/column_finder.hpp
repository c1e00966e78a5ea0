#pragma once

#include <string>
#include <vector>

#include "io/import/import_plan.hpp"

namespace modebank {

/// Finds columns in the tables of a plan's files. Adds them to the requests of the plan's sources. If a column does not
/// exist, throws ConfigurationError with the existing names.
class ColumnFinder {
 public:
  /// `plan` must have open readers.
  ColumnFinder(FilePlan& plan, std::shared_ptr<const DerivedChannels> derived);

  /// Finds a column of numbers. It is a derived channel, or a column of the first file that has it. `files`: indices in
  /// FilePlan::paths. A derived channel may also use other files.
  ColumnRef number(const std::string& column, const std::vector<std::size_t>& files);
  std::vector<ColumnRef> numbers(const std::vector<std::string>& columns, const std::vector<std::size_t>& files);

  /// The column of data.where.
  ColumnRef where(const std::vector<std::size_t>& files);
  /// A source that has the column.
  std::size_t clock_of(ColumnRef ref) const;

  /// The source of a file that provides only times. It is the file's only table, or `states` if that is in the same
  /// file.
  std::size_t source_without_column(std::size_t file, std::size_t states);

  /// The first of `sources` whose table has the times or the column.
  std::size_t first_with_time(const std::vector<std::size_t>& sources, const DataOptions& options) const;
  std::size_t first_with(const std::string& column, const std::vector<std::size_t>& sources) const;

  /// Requests the times of a source.
  void time(std::size_t source, const DataOptions& options);
  /// Requests a column of text. Returns the column's index in the request.
  std::size_t text(std::size_t source, const std::string& column);

  /// The source that has the column, in the first of `files` that has the column.
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
  std::vector<std::vector<TableInfo>> tables_;  // the tables of each file
};

}  // namespace modebank
