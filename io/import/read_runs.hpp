#pragma once

#include <map>
#include <string>
#include <vector>

#include "io/import/import.hpp"
#include "io/import/import_plan.hpp"
#include "io/import/options.hpp"
#include "io/import/row_reader.hpp"
#include "io/import/run_streams.hpp"
#include "io/import/stamp_agreement.hpp"

namespace modebank {

/// The content of one plan's files.
struct FileContent {
  std::vector<RunStreams> runs;   ///< runs sorted by name; roles are not set and samples are not sorted
  std::vector<InputFile> files;   ///< the files: inputs before states
  std::vector<FileStamps> forms;  ///< formats of the stamps
  UnsetRows unset;
  std::vector<std::string> notes;
  std::map<std::string, std::size_t> missing_words;  ///< sum of Table::missing_words over all tables
};

/// Reads one plan's files into streams, run by run. Throws DataError (io/import/import.hpp). Even then `result`
/// contains the formats of the stamps.
/// If a run's states (or inputs) come from several tables, they have the times of the first table. The other tables'
/// states are interpolated to these times, and their inputs are held. options.disorder determines how these streams are
/// sorted.
void read_runs(FilePlan plan, const DataOptions& options, FileContent& result);

}  // namespace modebank
