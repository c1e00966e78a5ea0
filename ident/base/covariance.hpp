#pragma once

#include <Eigen/Core>

namespace modebank {

/// Whether a matrix is finite, symmetric and positive semidefinite up to rounding, in any units of its rows.
bool is_covariance(const Eigen::MatrixXd& M);

}  // namespace modebank
