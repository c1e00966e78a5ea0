#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// The transition matrix between groups of modes, and of all modes that are in none taken as one group, which comes
/// last (where there are any): into a group goes the sum of its modes' probabilities, out of it the mean of theirs, by
/// `use`.
Eigen::MatrixXd folded_transition(const Eigen::MatrixXd& transition,
                                  const std::vector<std::vector<Eigen::Index>>& groups, const Eigen::VectorXd& use);

}  // namespace modebank
