#pragma once

#include <Eigen/Core>

namespace modebank {

/// Inverse of a symmetric positive definite matrix, by Cholesky's factor; all NaN where it is not definite.
Eigen::MatrixXd definite_inverse(const Eigen::MatrixXd& matrix);

}  // namespace modebank
