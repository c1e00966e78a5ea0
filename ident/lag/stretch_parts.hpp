#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Parts of the data that are left out together: whole runs, or stretches of runs if runs are few.
struct StretchParts {
  std::vector<Eigen::Index> part;  ///< N, index of each row's part
  Eigen::Index count = 0;
  bool by_runs = false;  ///< whether parts are whole runs
};

/// Divides rows into parts. Six or more runs are parts themselves; fewer runs are cut into at least ten stretches with
/// about equal numbers of rows. `run`: N, index of each row's run, below `runs`.
StretchParts stretch_parts(std::vector<Eigen::Index> run, Eigen::Index runs);

}  // namespace modebank
