#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "filter/learn/refine/refine.hpp"

namespace modebank {

/// The bank taken on from one-step likelihood to the maximum of what options.look_ahead and look_ahead_score count
/// (judge/look_ahead.hpp) and the prior: of densities over theta, Q, T and R where `R_estimated`; of errors over theta,
/// and then of the likelihood over the rest beside that theta. Kept where the runs left out, each
/// scored by a fit that has not seen it, gain more than least_gain, and where options.folds = 1 asks nobody. Nothing
/// where not, or where nothing can be left out; `stage` says what it was worth. It has no standard errors: those of a
/// composite likelihood are not its information's. Expectation-maximisation cannot see further than one step; this can,
/// at h / 2 times the cost of a likelihood for every coordinate's difference, so it makes few iterations, and none for
/// a bank of more than 50 coordinates.
std::optional<Fit> fit_looking_ahead(const RefineInput& in, const CrossValidation& validation, const Fit& fit,
                                     LookAheadStage& stage);

}  // namespace modebank
