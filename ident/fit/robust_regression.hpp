#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Huber's M-estimate of n linear regressions on the same q regressors, and its status.
struct RobustRegression {
  Eigen::MatrixXd coefficients;    ///< q x n; column i holds the coefficients of response i
  Eigen::MatrixXd standard_error;  ///< q x n; NaN for coefficients that the regressors do not determine
  Eigen::VectorXd scale;           ///< n, residual standard deviation: median |r| / 0.6745, about zero
  bool converged = false;
};

/// Fits increments = regressors * coefficients + noise, each increment separately, by iteratively reweighted least
/// squares. Weights are min(1, k scale / |r|) with k = default_loss_scale(Loss::huber). The scale is estimated again in
/// every iteration, until the fit moves by less than 1e-12 of the scale. Standard errors: Huber (1981), eq. 7.6.7 with
/// its correction K. A zero scale (more than half of the residuals are zero) ends the iteration as converged.
/// Rank-deficient regressors (excitation_tolerance) give the minimum-norm solution. Throws std::invalid_argument
/// without transitions or with entries that are not finite.
RobustRegression huber_regression(const Transitions& transitions);

/// Coefficients of a regression of one response, with the loss and scale of a window fit. Empty if the fit fails. If
/// the regressors are rank deficient, the solution has minimum norm.
Eigen::VectorXd robust_coefficients(const Transitions& transitions, const FitOptions& options);
/// The result of robust_coefficients; if that fails, the least-squares coefficients.
Eigen::VectorXd robust_or_least_squares(const Transitions& transitions, const FitOptions& options);

}  // namespace modebank
