#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Parts of the data that are left out together. They are whole runs, or stretches of runs if there are few runs.
struct StretchParts {
  std::vector<Eigen::Index> part;  ///< N, index of each row's part
  Eigen::Index count = 0;
  bool by_runs = false;  ///< true: the parts are whole runs; false: stretches of runs
};

/// Divides rows into parts. With `fewest_runs` or more, the parts are the runs. Fewer runs are cut into at least
/// `fewest_parts` stretches with about equal numbers of rows. `run`: N, index of each row's run, below `runs`.
StretchParts stretch_parts(std::vector<Eigen::Index> run, Eigen::Index runs, Eigen::Index fewest_runs = 6,
                           Eigen::Index fewest_parts = 10);

}  // namespace modebank
