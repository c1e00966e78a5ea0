#pragma once

#include <limits>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/switching_regression.hpp"

namespace modebank {

/// A logit without any effect yet, for expectation-maximisation to go on with: its reference is the mean of the
/// regressors (x, v) over the usable transitions.
TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes);

/// Standard deviations of the regressors (x, v) over the usable transitions; one for a regressor that is
/// constant to rounding, which no weight can use. d.
Eigen::VectorXd regressor_spread(const TrainingTransitions& transitions);

/// What is believed of a guard.
struct GuardPrior {
  double width = 0.0;  ///< standard deviation of the weights in units of the regressors' spread; 0: there is no guard
  double memory_sd = std::numeric_limits<double>::infinity();  ///< SwitchingPrior::memory_sd
};

/// The prior with that of a guard's weights and memory.
SwitchingPrior with_guard(SwitchingPrior prior, const TrainingTransitions& transitions, const GuardPrior& guard);

/// Raises the expected log posterior of the switches, T and the logit's weights together: sum over transitions of
/// posterior.pairs log P(j | i, z), prior.counts on every log T_ij, weights and memory with their normal priors. One
/// step of Newton's method on the concave objective (McCullagh & Nelder 1989, section 5.2), halved until it rises: a
/// generalised maximisation (Dempster, Laird & Rubin 1977), which suffices for the likelihood never to fall. Returns
/// what is gained [nats].
double raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                       const SwitchingPrior& prior, SwitchingRegression& model);

}  // namespace modebank
