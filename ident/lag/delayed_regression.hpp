#pragma once

#include <Eigen/Core>

namespace modebank {

/// Weighted means of the rows removed.
Eigen::MatrixXd centred(const Eigen::MatrixXd& values, const Eigen::VectorXd& weights);

/// Minimum-norm weighted least-squares coefficients of Y = B X, n x m; directions in which X hardly varies (relative
/// eigenvalue of its Gram matrix below 1e-10) get none.
Eigen::MatrixXd regress_rows(const Eigen::MatrixXd& X, const Eigen::MatrixXd& Y, const Eigen::VectorXd& weights);

}  // namespace modebank
