#pragma once

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "filter/likelihood_ascent.hpp"
#include "filter/refine.hpp"
#include "filter/refine_validation.hpp"
#include "filter/switching_regression.hpp"

namespace modebank {

/// The prior once the states count as unknown: that of the fit with states measured exactly, but Q as if one more
/// transition of the modes' own harmonic mean covariance in `start` was seen. The global residual covariance, which
/// holds what the modes differ in, would outweigh the data of modes that differ much. A harmonic mean is at most a few
/// times the least Q, so no mode is drawn up by more than about its share of one transition.
SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start);

/// The fit where states are measured with noise: some steps of expectation-maximisation (switching_state_space.hpp),
/// as long as they raise the target, then the ascent to its maximum. Both count as iterations.
Ascent fit_with_states_unknown(const LikelihoodTarget& target, const AscentLimits& limits, Bank& bank);

/// The filter whose likelihood the fit raises: as the bank will be run, but an IMM with known parameters.
FilterOptions learning_filter(const FilterOptions& filter);

/// Where R is more than nothing (by estimate_measurement_noise in `filter`, or as given), fits on with the states
/// unknown and keeps that if it pays. Sets the target's prior to prior_with_states_unknown where it fits on.
MeasurementStage fit_with_measurement_noise(const RefineOptions& options, const FilterOptions& filter,
                                            const CrossValidation& validation, LikelihoodTarget& target, Bank& bank);

}  // namespace modebank
