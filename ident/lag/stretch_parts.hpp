#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Parts that are left out together: whole runs, or stretches of runs where these are few.
struct StretchParts {
  std::vector<Eigen::Index> part;  ///< N, position of the part that a row is of
  Eigen::Index count = 0;
  bool by_runs = false;  ///< parts are whole runs
};

/// At least six runs are parts; fewer are cut into stretches of about equal numbers of rows, ten or more together.
/// `run`: N, position below `runs` of the run that a row is of.
StretchParts stretch_parts(std::vector<Eigen::Index> run, Eigen::Index runs);

}  // namespace modebank
