#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// For every row the column assigned to it, one to one, such that the sum of the chosen values is largest. `values`
/// K x K, finite. Shortest augmenting paths (Jonker & Volgenant 1987, Computing 38), K^3 operations.
std::vector<Eigen::Index> best_assignment(const Eigen::MatrixXd& values);

}  // namespace modebank
