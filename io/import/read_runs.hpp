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
  std::vector<RunStreams> runs;   ///< sorted by name; roles not yet set, samples not yet in order
  std::vector<InputFile> files;   ///< inputs before states
  std::vector<FileStamps> forms;  ///< of the stamps that were read
  UnsetRows unset;
  std::vector<std::string> notes;
  std::map<std::string, std::size_t> missing_words;  ///< Table::missing_words of all tables
};

/// Reads one plan's files into streams, run by run; `result` keeps the stamps' forms where it throws. Where a run's
/// states (or inputs) come from several tables, the first one's table gives the times: other states are interpolated
/// onto them, other inputs held; these streams are put in order as options.disorder says. Throws DataError
/// (io/import/import.hpp).
void read_runs(const FilePlan& plan, const DataOptions& options, FileContent& result);

}  // namespace modebank
