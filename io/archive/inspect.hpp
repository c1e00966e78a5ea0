#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "io/archive/bank/open_archive.hpp"

namespace modebank {

/// One object of an archive as JSON: a group becomes {"attributes": {...}, "members": {name: {kind, shape, units}}}, a
/// dataset {"attributes": ..., "shape": ..., "value": nested arrays or, for tables, an array of row objects, whose
/// "columns" are listed in the file's order}. NaN becomes null.
///
/// With the name of a run, arrays over samples have the run's rows alone, and tables with the column `run` its rows;
/// the root becomes {"run": its row of /data/runs, "members": of /data and of every filter's evaluation, by path}.
///
/// Throws ConfigurationError for a path that the file lacks (with the members of the deepest existing group), for an
/// unknown run (with the known ones), and for a path without arrays by run.
nlohmann::json inspect(const OpenArchive& archive, const std::string& path, const std::string& run = "");

}  // namespace modebank
