#pragma once

#include <Eigen/Core>

#include "ident/fit/options.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Coefficients of a regression of one response by the loss and the scale of a window's fit; empty where that fails.
/// Regressors of deficient rank count for what they determine.
Eigen::VectorXd robust_coefficients(const Transitions& transitions, const FitOptions& options);
/// Least squares where that fails.
Eigen::VectorXd robust_or_least_squares(const Transitions& transitions, const FitOptions& options);

}  // namespace modebank
