#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "io/import/derived.hpp"
#include "io/import/memory_tables.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// One table to read from a file.
struct SourcePlan {
  std::size_t path = 0;  ///< index in FilePlan::paths
  TableRequest request;
  std::vector<DerivedColumn> derived;  ///< channels derived only from columns of this table, in order of position
  std::optional<std::size_t> run;      ///< index of the column of run names in TableRequest::texts
};

/// Source of a channel that is derived from several sources. The columns of these sources are first brought to the same
/// times.
inline constexpr auto joint_source = static_cast<std::size_t>(-1);

/// Location of a requested column.
struct ColumnRef {
  std::size_t source = 0;  ///< index in FilePlan::sources, or joint_source
  std::size_t column = 0;  ///< index in TableRequest::numbers of that source, or in FilePlan::joint
};

struct JointColumn {
  std::shared_ptr<const DerivedChannel> channel;
  std::vector<ColumnRef> operands;
};

/// The data to read from one inputs file and its states file. Only the files' headers are needed to make the plan.
struct FilePlan {
  std::string name;                                         ///< the text that `*` matched, or the file's stem
  bool starred = false;                                     ///< whether the pattern had a `*`
  std::vector<std::filesystem::path> paths;                 ///< the inputs file, then the states file, if any
  std::vector<std::shared_ptr<const TableReader>> readers;  ///< one for each path
  std::vector<SourcePlan> sources;                          ///< the tables with requested columns
  std::vector<ColumnRef> state, input, truth;
  std::vector<ColumnRef> where;  ///< at most one channel
  std::vector<JointColumn> joint;
  std::vector<Channel> states, inputs;  ///< names of the channels; units if the files state them
  bool by_row = false;                  ///< true for Join::row
  /// Sources of the times of states and of inputs. They are the same source if rows correspond, or if the first state
  /// and the first input are in one table. Columns of other sources are computed at these times.
  std::size_t states_clock = 0, inputs_clock = 0;
  std::size_t runs_source = 0;     ///< if rows correspond: the source whose text column contains the run names, if any
  std::optional<ColumnRef> label;  ///< index of the column of labels in TableRequest::texts
  std::vector<std::string> notes;

  /// Whether row i of a source corresponds to row i of every other source. This holds for a single table and for
  /// Join::row.
  bool rows_correspond() const { return by_row || sources.size() == 1; }

  /// The requests for one file. `sources` lists where they come from.
  struct FileRequests {
    std::vector<std::size_t> sources;
    std::vector<TableRequest> requests;
  };
  FileRequests requests_of(std::size_t path) const;
};

/// Checks options, finds the files and reads their headers. Plans are in the order of `name`. Unless a column contains
/// run names, runs that are neither in data.train nor in data.test are skipped. Throws ConfigurationError
/// (io/import/import.hpp). If `memory` is given, its tables are the runs, and no files are read.
std::vector<FilePlan> plan_import(const DataOptions& options, const MemoryTables* memory = nullptr);

}  // namespace modebank
