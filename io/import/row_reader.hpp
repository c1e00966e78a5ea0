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

/// The rows of one run, per source, and what its times count from.
struct RunSlice {
  std::vector<Rows> rows;
  std::int64_t origin_ns = 0;
};

/// Rows that were stamped before the clock was set, which are left out.
struct UnsetRows {
  std::size_t count = 0;
  std::string example = {};  ///< the place and the stamps around of the first ones

  void add(const UnsetRows& other) {
    if (count == 0) example = other.example;
    count += other.count;
  }
  std::string note() const;  ///< empty without any
};

/// Tables' view of the runs: which rows belong to which, and their values. Keeps references.
class RowReader {
 public:
  RowReader(const FilePlan& plan, const std::vector<Table>& tables, const DataOptions& options)
      : plan_(plan), tables_(tables), options_(options) {}

  RunRows rows_by_run(std::size_t source) const;

  /// What the run's times count from: nothing, or its first sample where that is long after.
  std::int64_t origin_ns(const std::vector<Rows>& rows) const;

  /// The samples of `clock`, with the columns `refs` of whatever source; those of others are brought to its times, and
  /// what is derived from several sources is computed there.
  FileStream stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  /// Takes the rows out of the run that were stamped before the clock was set.
  UnsetRows leave_out_unset(RunSlice& run) const;

  /// Throws DataError for stamps of the run that are out by orders of magnitude.
  void check_stamps(const RunSlice& run) const;

  /// What is known of the run, at the times of the table that says it.
  LabelStream labels(const RunSlice& run) const;

  /// Weights, none negative.
  void check_weights(ColumnRef ref, const Rows& rows) const;

 private:
  /// Adds the columns of tables that `ref` is made from.
  void gather_columns(ColumnRef ref, std::vector<ColumnRef>& read) const;

  Eigen::VectorXd derived(ColumnRef ref, const std::vector<ColumnRef>& read, const Stream& from) const;

  FileStream brought(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run, Bring bring) const;

  std::string place(std::size_t source, std::size_t row) const;

  Eigen::VectorXd times(std::size_t source, const RunSlice& run) const;

  /// Times of a source and those of the columns that are its own; the others stay empty rows. Where rows correspond all
  /// are its own.
  FileStream own_stream(std::size_t clock, const std::vector<ColumnRef>& refs, const RunSlice& run) const;

  Eigen::VectorXd column(ColumnRef ref, const Rows& rows) const;

  const FilePlan& plan_;
  const std::vector<Table>& tables_;
  const DataOptions& options_;
};

}  // namespace modebank
