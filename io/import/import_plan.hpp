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

/// One table that is read, of which file.
struct SourcePlan {
  std::size_t path = 0;  ///< position in FilePlan::paths
  TableRequest request;
  std::vector<DerivedColumn> derived;  ///< of this table's columns alone, in order of position
  std::optional<std::size_t> run;      ///< position in TableRequest::texts of the rows' run names
};

/// Stands for a source where a channel is derived from several, after they were brought to the same times.
inline constexpr auto joint_source = static_cast<std::size_t>(-1);

/// Where one wanted column stands.
struct ColumnRef {
  std::size_t source = 0;  ///< position in FilePlan::sources, or joint_source
  std::size_t column = 0;  ///< position in that source's TableRequest::numbers, or in FilePlan::joint
};

struct JointColumn {
  std::shared_ptr<const DerivedChannel> channel;
  std::vector<ColumnRef> operands;
};

/// What is to be read of one inputs file and its states file, decided on the headers alone.
struct FilePlan {
  std::string name;                                         ///< what the * matched, or the file's stem
  bool starred = false;                                     ///< whether there was a *
  std::vector<std::filesystem::path> paths;                 ///< inputs file, then the states file if there is one
  std::vector<std::shared_ptr<const TableReader>> readers;  ///< one per path
  std::vector<SourcePlan> sources;                          ///< the tables that columns come from
  std::vector<ColumnRef> state, input, truth;
  std::vector<ColumnRef> weight;  ///< one or none
  std::vector<ColumnRef> where;   ///< one or none
  std::vector<JointColumn> joint;
  std::vector<Channel> states, inputs;  ///< names, and units where the files say them
  bool by_row = false;                  ///< Join::row
  /// Sources whose times the states and the inputs have; one and the same where rows correspond, or where the first
  /// state and the first input stand in one table. What comes from another source is brought to these times.
  std::size_t states_clock = 0, inputs_clock = 0;
  std::size_t runs_source = 0;     ///< where rows correspond: whose text column holds the rows' run names, if any
  std::optional<ColumnRef> label;  ///< column of labels, in TableRequest::texts
  std::vector<std::string> notes;

  /// Whether row i of every source belongs to row i of the others (one table, or Join::row).
  bool rows_correspond() const { return by_row || sources.size() == 1; }

  /// What is read of a file, and by which of `sources`.
  struct FileRequests {
    std::vector<std::size_t> sources;
    std::vector<TableRequest> requests;
  };
  FileRequests requests_of(std::size_t path) const;
};

/// Checks options, finds the files and reads their headers, in order of `name`. Runs that neither data.train nor
/// data.test names are left out, unless a column names the runs. Throws ConfigurationError (io/import/import.hpp).
/// With `memory` the runs are those tables, and no file is looked for.
std::vector<FilePlan> plan_import(const DataOptions& options, const MemoryTables* memory = nullptr);

}  // namespace modebank
