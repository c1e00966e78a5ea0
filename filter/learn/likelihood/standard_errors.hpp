#pragma once

#include <Eigen/Core>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Everything about a bank as free parameters, theta in units of its standard errors given the smoothed modes.
/// `complete`: a fit's expected sums. `estimate_R`: with R of all outputs, at least `least_R` (n_y).
FreeParameters all_parameters(const Bank& bank, const SwitchingSums& complete, const SwitchingPrior& prior,
                              bool one_theta, bool estimate_R, const Eigen::VectorXd& least_R);

/// The bank with standard errors of its theta, Q, T and R where these are free, and theta's covariance as the modes'
/// spread: the inverse of the observed information (information.hpp) with the prior's added, of all parameters
/// together, in the filter and with the sample weights of the target. So it allows for what is not known about the
/// modes and, with R > 0, about the states, which the expected sums of the fit (Louis 1982's complete information) do
/// not. It supposes that the model is true. Of long recordings it takes stretches of all training
/// runs (learning_part.hpp) and scales up. Where the
/// information has no inverse the errors are those of the complete information, and R's are NaN.
///
/// target.prior is required; `free` is all_parameters of the same bank.
Bank with_standard_errors(const LikelihoodTarget& target, const FreeParameters& free, const SwitchingSums& complete,
                          Bank bank);

}  // namespace modebank
