#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Assigns one column to each row, one to one, so that the sum of the chosen values is largest. `values` is K x K and
/// finite. The method is shortest augmenting paths (Jonker & Volgenant 1987, Computing 38), with K^3 operations.
std::vector<Eigen::Index> best_assignment(const Eigen::MatrixXd& values);

}  // namespace modebank
