#pragma once

#include <string>
#include <vector>

#include "ident/trajectory.hpp"
#include "io/data_options.hpp"
#include "io/import.hpp"
#include "io/import_plan.hpp"

namespace modebank {

/// The content of one plan's files.
struct FileContent {
  std::vector<Trajectory> runs;  ///< sorted by name; roles not yet set
  std::vector<InputFile> files;  ///< inputs before states
};

/// Reads one plan's files and joins their streams. Throws DataError (io/import.hpp).
FileContent read_runs(const FilePlan& plan, const DataOptions& options);

}  // namespace modebank
