#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/import/options.hpp"
#include "io/import/table_reader.hpp"

namespace modebank {

/// Where one wanted column stands.
struct ColumnRef {
  std::size_t file = 0;    ///< position in FilePlan::paths
  std::size_t column = 0;  ///< position in that file's TableRequest::numbers
};

/// What is to be read of one inputs file and its states file, decided on the headers alone.
struct FilePlan {
  std::string name;                          ///< what the * matched, or the file's stem
  bool starred = false;                      ///< whether there was a *
  std::vector<std::filesystem::path> paths;  ///< inputs file, then the states file if there is one
  std::vector<TableRequest> requests;        ///< one per path
  std::vector<ColumnRef> state, input, truth;
  std::vector<ColumnRef> weight;                 ///< one or none
  ColumnRef inputs_time, states_time;            ///< the same column where rows correspond
  std::size_t inputs_runs = 0, states_runs = 0;  ///< files whose text column holds the rows' run names, if any

  /// Whether row i of every file belongs to row i of the others (one file, or Join::row).
  bool rows_correspond() const { return inputs_time.file == states_time.file; }
};

/// Checks options, finds the files and reads their headers, in order of `name`. Runs that neither data.train nor
/// data.test names are left out, unless a column names the runs. Throws ConfigurationError (io/import/import.hpp).
std::vector<FilePlan> plan_import(const DataOptions& options);

}  // namespace modebank
