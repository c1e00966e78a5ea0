#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "io/import/options.hpp"
#include "io/table/table_reader.hpp"

namespace modebank {

/// One table that is read, of which file.
struct SourcePlan {
  std::size_t path = 0;  ///< position in FilePlan::paths
  TableRequest request;
};

/// Where one wanted column stands.
struct ColumnRef {
  std::size_t source = 0;  ///< position in FilePlan::sources
  std::size_t column = 0;  ///< position in that source's TableRequest::numbers
};

/// What is to be read of one inputs file and its states file, decided on the headers alone.
struct FilePlan {
  std::string name;                                         ///< what the * matched, or the file's stem
  bool starred = false;                                     ///< whether there was a *
  std::vector<std::filesystem::path> paths;                 ///< inputs file, then the states file if there is one
  std::vector<std::shared_ptr<const TableReader>> readers;  ///< one per path
  std::vector<SourcePlan> sources;                          ///< the tables that columns come from
  std::vector<ColumnRef> state, input, truth;
  std::vector<ColumnRef> weight;        ///< one or none
  std::vector<Channel> states, inputs;  ///< names, and units where the files say them
  /// Sources whose times the states and the inputs have; one and the same where rows correspond. What comes from
  /// another source is brought to these times.
  std::size_t states_clock = 0, inputs_clock = 0;
  std::size_t runs_source = 0;  ///< where rows correspond: whose text column holds the rows' run names, if any
  std::string label;            ///< column of labels in the table of label_source; empty: none
  std::size_t label_source = 0;
  std::vector<std::string> notes;

  /// Whether row i of every source belongs to row i of the others (one table, or Join::row).
  bool rows_correspond() const { return states_clock == inputs_clock; }
};

/// Checks options, finds the files and reads their headers, in order of `name`. Runs that neither data.train nor
/// data.test names are left out, unless a column names the runs. Throws ConfigurationError (io/import/import.hpp).
std::vector<FilePlan> plan_import(const DataOptions& options);

}  // namespace modebank
