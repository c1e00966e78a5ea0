#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Z' Z with Z = diag(root) [left right](rows), symmetric to the bit. `root`: one per row of the list. Requires `left`
/// and `right` to have as many rows. One order of summation per instruction set, whatever the number of threads.
Eigen::MatrixXd weighted_gram(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                              const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& root);

}  // namespace modebank
