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
using RunRows = std::map<std::string, Rows>;  // sorted by run name, byte order

/// The rows of one run, per source, and the origin of its times.
struct RunSlice {
  std::vector<Rows> rows;
  std::int64_t origin_ns = 0;
};

/// Rows that were left out, stamped before the clock was set.
struct UnsetRows {
  std::size_t count = 0;
  std::string example = {};  ///< text on the first of these rows, with the stamps of its neighbours

  void add(const UnsetRows& other) {
    if (count == 0) example = other.example;
    count += other.count;
  }
  std::string note() const;  ///< empty if there are none
};

/// Rows of tables by run, with access to their values. Keeps references to its arguments.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<Table>& tables, const DataOptions& options)
      : plan_(plan), tables_(tables), options_(options) {}

  RunRows rows_by_run(std::size_t source) const;

  /// Origin of the run's times: 0, or its first sample if that is long after 0.
  std::int64_t origin_ns(const std::vector<Rows>& rows) const;

  /// The samples of `clock` with the columns `refs`. The values of other sources' columns are computed at the times of
  /// `clock`, and so are channels derived from several sources.
  FileStream stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  /// Removes rows of the run that were stamped before the clock was set.
  UnsetRows leave_out_unset(RunSlice& run) const;

  /// Throws DataError for stamps that differ from their neighbours by orders of magnitude.
  void check_stamps(const RunSlice& run) const;

  /// Labels of the run, at the times of their own table.
  LabelStream labels(const RunSlice& run) const;

  /// Throws unless all weights are at least 0.
  void check_weights(ColumnRef ref, const Rows& rows) const;

 private:
  /// Adds the columns of tables from which `ref` is made.
  void gather_columns(ColumnRef ref, std::vector<ColumnRef>& read) const;

  Eigen::VectorXd derived(ColumnRef ref, const std::vector<ColumnRef>& read, const Stream& from) const;

  FileStream brought(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  std::string place(std::size_t source, std::size_t row) const;

  Eigen::VectorXd times(std::size_t source, const RunSlice& run) const;

  /// Times of a source with its own columns. Rows of other sources' columns stay empty. If rows correspond, all columns
  /// are the source's own.
  FileStream own_stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run) const;

  Eigen::VectorXd column(ColumnRef ref, const Rows& rows) const;

  const FilePlan& plan_;
  const std::vector<Table>& tables_;
  const DataOptions& options_;
};

}  // namespace modebank
