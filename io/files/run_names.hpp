#pragma once

#include <string>
#include <vector>

namespace modebank {

/// Names of runs in any struct with a member `run`.
template <class Run>
std::vector<std::string> run_names(const std::vector<Run>& runs) {
  std::vector<std::string> names;
  for (const Run& run : runs) names.push_back(run.run);
  return names;
}

/// Run names are texts of the archive and parts of file names. Throws DataError for an invalid name, and if two runs
/// have the same name. Invalid are the empty name, names with '/' or a zero byte, the folders "." and "..", and "*",
/// which means all runs in the summary.
void check_run_names(const std::vector<std::string>& names);

}  // namespace modebank
