#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// Labels of each sample of the runs, such as the kind of ground. A label is a position in `names`, or -1 if unknown.
struct RunLabels {
  std::vector<std::string> names;
  std::vector<Eigen::VectorXi> of_runs;  ///< in the recording's order, one value per sample
};

}  // namespace modebank
