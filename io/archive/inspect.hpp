#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// One object of an archive as JSON.
/// - A group: {"attributes": {...}, "members": {name: {kind, shape, units}}}.
/// - A dataset: {"attributes": ..., "shape": ..., "value": nested arrays}. The value of a table is an array of row
///   objects, and "columns" lists their names in the file's order.
/// - NaN becomes null.
///
/// With the name of a run, arrays over samples contain only this run's rows, and so do tables with the column `run`.
/// The root becomes {"run": the run's row of /data/runs, "members": arrays of /data and of every filter's evaluation,
/// by path}.
///
/// Throws ConfigurationError for a path that does not exist (with the members of the deepest existing group), for an
/// unknown run (with the known runs), and for a path without arrays by run.
nlohmann::json inspect(const OpenArchive& archive, const std::string& path, const std::string& run = "");

}  // namespace modebank
