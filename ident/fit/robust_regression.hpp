#pragma once

#include <Eigen/Core>

#include "ident/model/transitions.hpp"

namespace modebank {

/// Huber's M-estimate of n linear regressions on the same q regressors, and how it ended.
struct RobustRegression {
  Eigen::MatrixXd coefficients;    ///< q x n, column i explains response i
  Eigen::MatrixXd standard_error;  ///< q x n; NaN where the regressors cannot tell the coefficients apart
  Eigen::VectorXd scale;           ///< n, residual standard deviation: median |r| / 0.6745, not centred
  bool converged = false;
};

/// Fits increments = regressors * coefficients + noise by iteratively reweighted least squares from least squares, each
/// increment on its own; weights min(1, k scale / |r|) with k = default_loss_scale(Loss::huber), the scale re-estimated
/// in every iteration, until the fit moves by less than 1e-12 of its scale. Standard errors: Huber (1981), eq. 7.6.7
/// with its correction K. A scale of zero (more than half of the residuals are zero) ends the iteration there,
/// converged. Regressors of deficient rank (excitation_tolerance) give the solution of least norm. Throws
/// std::invalid_argument without any transition or with entries that are not finite.
RobustRegression huber_regression(const Transitions& transitions);

}  // namespace modebank
