#pragma once

#include <Eigen/Core>

namespace modebank {

/// Whether a matrix is finite, symmetric and positive semidefinite up to rounding. The units of its rows do not matter.
bool is_covariance(const Eigen::MatrixXd& M);

}  // namespace modebank
