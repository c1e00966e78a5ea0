#pragma once

#include <Eigen/Core>

namespace modebank {

/// Subtracts the weighted means of the rows.
Eigen::MatrixXd centred(const Eigen::MatrixXd& values, const Eigen::VectorXd& weights);

/// Minimum-norm weighted least-squares coefficients of Y = B X, n x m. Directions in which X hardly varies (relative
/// eigenvalue of its Gram matrix below 1e-10) get zero coefficients.
Eigen::MatrixXd regress_rows(const Eigen::MatrixXd& X, const Eigen::MatrixXd& Y, const Eigen::VectorXd& weights);

}  // namespace modebank
