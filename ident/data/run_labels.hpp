#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// Labels of each sample of the runs, such as the kind of ground: positions in `names`, -1 where unknown.
struct RunLabels {
  std::vector<std::string> names;
  std::vector<Eigen::VectorXi> of_runs;  ///< in the recording's order, one value per sample
};

}  // namespace modebank
