#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// One object of an archive as JSON.
/// - A group becomes {"attributes": {...}, "members": {name: {kind, shape, units}}}.
/// - A dataset becomes {"attributes": ..., "shape": ..., "value": nested arrays}.
/// - In a table, "value" is an array of row objects, and "columns" lists the columns' names in the order of the file.
/// - NaN becomes null.
///
/// If a run is named, arrays over samples and tables with a column `run` contain only this run's rows. The root becomes
/// {"run": the run's row of /data/runs, "members": arrays of /data and of every filter's evaluation, by path}.
///
/// Throws ConfigurationError in three cases. A path does not exist: the message lists the members of the deepest
/// existing group. A run is unknown: the message lists the known runs. A path has no arrays by run.
nlohmann::json inspect(const OpenArchive& archive, const std::string& path, const std::string& run = "");

}  // namespace modebank
