#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Coefficients of a regression of one response, with the loss and scale of a window fit. Empty if the fit fails. If
/// the regressors are rank deficient, the solution has minimum norm.
Eigen::VectorXd robust_coefficients(const Transitions& transitions, const FitOptions& options);
/// The result of robust_coefficients; if that fails, the least-squares coefficients.
Eigen::VectorXd robust_or_least_squares(const Transitions& transitions, const FitOptions& options);

}  // namespace modebank
