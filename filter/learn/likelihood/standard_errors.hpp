#pragma once

#include <Eigen/Core>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// All parameters of a bank as free parameters, with theta in units of its standard errors given the smoothed modes.
/// `complete`: expected sums of a fit. `estimate_R`: includes R of all outputs, at least `least_R` (n_y).
FreeParameters all_parameters(const Bank& bank, const SwitchingSums& complete, const SwitchingPrior& prior,
                              bool one_theta, bool estimate_R, const Eigen::VectorXd& least_R);

/// The bank with standard errors of its free parameters among theta, Q, T and R. The covariance of theta becomes the
/// parameter covariance of the modes. The errors come from the inverse of the observed information (information.hpp)
/// plus the information of the prior. The inverse is for all parameters together, in the target's filter. So the errors
/// include the uncertainty of the modes and, for R > 0, of the states. The fit's expected sums (Louis 1982's complete
/// information) do not include this uncertainty. The model is assumed true. Long recordings are reduced to stretches of
/// all training runs (learning_part.hpp), and the information is scaled up. If the information is singular, the errors
/// come from the complete information, and those of R are NaN.
///
/// Requires target.prior; `free` is all_parameters of the same bank.
Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, const SwitchingSums& complete,
                          Bank bank);

}  // namespace modebank
