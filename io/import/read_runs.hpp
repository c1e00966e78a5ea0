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
  std::vector<RunStreams> runs;   ///< sorted by name; without roles, samples unsorted
  std::vector<InputFile> files;   ///< inputs before states
  std::vector<FileStamps> forms;  ///< formats of the stamps
  UnsetRows unset;
  std::vector<std::string> notes;
  std::map<std::string, std::size_t> missing_words;  ///< sum of Table::missing_words
};

/// Reads one plan's files into streams, run by run. If it throws, `result` still has the formats of the stamps. If a
/// run's states (or inputs) come from several tables, the first table gives the times: other states are interpolated to
/// these times, other inputs held. options.disorder puts these streams in order. Throws DataError
/// (io/import/import.hpp).
void read_runs(const FilePlan& plan, const DataOptions& options, FileContent& result);

}  // namespace modebank
