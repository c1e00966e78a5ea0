#pragma once

#include <string>
#include <vector>

namespace modebank {

/// Of runs in any form that has a `run`.
template <class Run>
std::vector<std::string> run_names(const std::vector<Run>& runs) {
  std::vector<std::string> names;
  for (const Run& run : runs) names.push_back(run.run);
  return names;
}

/// Run names are texts of the archive and names of files. Throws DataError for a name that cannot be one ('/' separates
/// folders, "." and ".." are folders already, texts end at a zero byte, "*" is all runs in the summary) or that two
/// runs share.
void check_run_names(const std::vector<std::string>& names);

}  // namespace modebank
