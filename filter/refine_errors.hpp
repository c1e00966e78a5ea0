#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "filter/switching_regression.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Every mode's share of the transitions. `transitions`: K, sum of its probabilities.
void set_weights(const Eigen::VectorXd& transitions, Bank& bank);

/// Standard errors of a refined bank's theta, Q, T and (`with_R`) R, and theta's covariance, which becomes the modes'
/// spread: the inverse of the observed information with the prior's added. The information is the sum of outer products
/// of the scores of single samples (Berndt, Hall, Hall & Hausman 1974), that is of the derivatives of the filter's log
/// predictive densities by all parameters together: so it allows for what is not known about the modes and, with R > 0,
/// about the states, which the expected sums of the fit (Louis 1982's complete information) do not. It supposes that
/// the model is true. Of long recordings it takes the first samples and scales up.
///
/// `complete`: the fit's expected sums; they give the steps of the derivatives, and the errors where the information
/// is not finite.
void set_standard_errors(const Recording& recording, const SwitchingSums& complete, const SwitchingPrior& prior,
                         SharedParts shared, bool with_R, Bank& bank);

}  // namespace modebank
