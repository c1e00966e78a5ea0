#pragma once

#include <string>
#include <vector>

#include "io/import/import.hpp"
#include "io/import/import_plan.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

/// The content of one plan's files.
struct FileContent {
  std::vector<RunStreams> runs;  ///< sorted by name; roles not yet set, samples not yet in order
  std::vector<InputFile> files;  ///< inputs before states
};

/// Reads one plan's files into streams, run by run. Throws DataError (io/import/import.hpp).
FileContent read_runs(const FilePlan& plan, const DataOptions& options);

}  // namespace modebank
