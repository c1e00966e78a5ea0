#pragma once

#include <Eigen/Core>
#include <vector>

namespace modebank {

/// The transition matrix of the modes `told`, in that order, and of all others taken as one, which comes last (where
/// there are any): into them goes the sum of their probabilities, out of them the mean of theirs, by `use`.
Eigen::MatrixXd folded_transition(const Eigen::MatrixXd& transition, const std::vector<Eigen::Index>& told,
                                  const Eigen::VectorXd& use);

}  // namespace modebank
