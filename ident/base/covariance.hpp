#pragma once

#include <Eigen/Core>

namespace modebank {

/// Whether a matrix is finite, symmetric and positive semidefinite, up to rounding and whatever the units of its rows.
bool is_covariance(const Eigen::MatrixXd& M);

}  // namespace modebank
