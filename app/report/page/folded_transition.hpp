#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// Transition matrix between groups of modes. Modes without a group, if any, form a last group. The probability of
/// entering a group is the sum over its modes. The probability of leaving a group is the mean over its modes, weighted
/// by `use`.
Eigen::MatrixXd folded_transition(const Eigen::MatrixXd& transition,
                                  const std::vector<std::vector<Eigen::Index>>& groups, const Eigen::VectorXd& use);

}  // namespace modebank
