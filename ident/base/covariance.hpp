#pragma once

#include <Eigen/Core>

namespace modebank {

/// Whether a matrix is finite, symmetric and positive semidefinite up to rounding. The units of its rows do not matter.
bool is_covariance(const Eigen::MatrixXd& M);

/// A root of a covariance: its product with standard normal numbers has this covariance. It has fewer columns than rows
/// where the covariance is singular.
Eigen::MatrixXd covariance_root(const Eigen::MatrixXd& M);

}  // namespace modebank
