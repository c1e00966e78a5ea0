#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "filter/learn/refine/refine.hpp"

namespace modebank {

/// Continues the fit from one-step likelihood to the maximum of the look-ahead score and the prior (options.look_ahead,
/// look_ahead_score; look_ahead_scores).
/// - Densities: the search is over theta, Q, T and, with `R_estimated`, R.
/// - Errors: the search is over theta; then the likelihood is maximised over the other parameters with that theta.
/// The result is kept if left-out runs, each scored by a fit without that run, gain more than least_gain. With
/// options.folds = 1 it is always kept. Otherwise the result is empty. `stage` records the gain. The result has no
/// standard errors, because a composite likelihood does not have the usual information.
/// Expectation-maximisation cannot look further than one step. This search can. For each coordinate it costs h / 2
/// times as much as a likelihood. So it makes few iterations, and none for a bank of more than 50 coordinates.
std::optional<Fit> fit_looking_ahead(const RefineInput& in, const CrossValidation& validation, const Fit& fit,
                                     LookAheadStage& stage);

}  // namespace modebank
