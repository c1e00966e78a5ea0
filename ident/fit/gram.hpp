#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Z' Z with Z = diag(root) [left right](rows), symmetric to the bit. `root` has one entry per listed row.  `left` and
/// `right` have equal numbers of rows. The order of summation depends on the instruction set, but not on the number of
/// threads.
Eigen::MatrixXd weighted_gram(const Eigen::MatrixXd& left, const Eigen::MatrixXd& right,
                              const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& root);

}  // namespace modebank
