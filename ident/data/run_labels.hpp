#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modebank {

/// What is known of the runs of a recording sample by sample, as the ground they drove on: positions in `names`, -1
/// where nothing is known.
struct RunLabels {
  std::vector<std::string> names;
  std::vector<Eigen::VectorXi> of_runs;  ///< in the recording's order, one value per sample
};

}  // namespace modebank
