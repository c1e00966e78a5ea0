#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/import/bring.hpp"
#include "io/import/import_plan.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

using Rows = std::vector<std::size_t>;
using RunRows = std::map<std::string, Rows>;  // sorted by run name in byte order

/// The rows of one run in each source, and the origin of the run's times.
struct RunSlice {
  std::vector<Rows> rows;
  std::int64_t origin_ns = 0;
};

/// Rows that were removed because they were stamped before the clock was set.
struct UnsetRows {
  std::size_t count = 0;
  std::string example = {};  ///< text about the first of these rows, with its neighbours' stamps

  void add(const UnsetRows& other) {
    if (count == 0) example = other.example;
    count += other.count;
  }
  std::string note() const;  ///< empty if no rows were removed
};

/// The rows of tables, by run, and access to their values. Keeps references to the constructor's arguments.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<Table>& tables, const DataOptions& options)
      : plan_(plan), tables_(tables), options_(options) {}

  RunRows rows_by_run(std::size_t source) const;

  /// Origin of the run's times. It is 0, or the time of the first sample if this time is far above 0.
  std::int64_t origin_ns(const std::vector<Rows>& rows) const;

  /// The samples of `clock` with the columns `refs`. Columns of other sources, and channels derived from several
  /// sources, are computed at the times of `clock`.
  FileStream stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  /// Removes the run's rows that were stamped before the clock was set.
  UnsetRows leave_out_unset(RunSlice& run) const;

  /// Throws DataError if a stamp differs from its neighbours by orders of magnitude.
  void check_stamps(const RunSlice& run) const;

  /// The run's labels, at the times of the table with the labels.
  LabelStream labels(const RunSlice& run) const;

 private:
  /// Adds the table columns from which `ref` is computed.
  void gather_columns(ColumnRef ref, std::vector<ColumnRef>& read) const;

  Eigen::VectorXd derived(ColumnRef ref, const std::vector<ColumnRef>& read, const Stream& from) const;

  FileStream brought(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  std::string place(std::size_t source, std::size_t row) const;

  Eigen::VectorXd times(std::size_t source, const RunSlice& run) const;

  /// The times and columns of one source. The rows of other sources' columns stay empty. If the sources' rows
  /// correspond, all columns count as the source's own.
  FileStream own_stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run) const;

  Eigen::VectorXd column(ColumnRef ref, const Rows& rows) const;

  const FilePlan& plan_;
  const std::vector<Table>& tables_;
  const DataOptions& options_;
};

}  // namespace modebank
