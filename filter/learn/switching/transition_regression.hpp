#pragma once

#include <limits>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/switching_regression.hpp"

namespace modebank {

/// A logit without effect, as a start for expectation-maximisation. Its reference is the mean of the regressors (x, v)
/// over the usable transitions.
TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes);

/// Standard deviations of the regressors (x, v) over the usable transitions, d. The value is one if a regressor is
/// constant up to rounding; its weight then has no effect.
Eigen::VectorXd regressor_sd(const TrainingTransitions& transitions);

/// Prior of state-dependent transition probabilities.
struct LogitPrior {
  double width = 0.0;  ///< standard deviation of the weights in units of the regressors' standard deviation; 0 means
                       ///< constant T
  double memory_sd = std::numeric_limits<double>::infinity();  ///< SwitchingPrior::memory_sd
};

/// The prior, with an additional prior of the logit's weights and memory.
SwitchingPrior with_logit_prior(SwitchingPrior prior, const TrainingTransitions& transitions,
                                const LogitPrior& logit_prior);

/// Raises the expected log posterior of the switches over T and the logit's weights together. The objective is the sum
/// over transitions of posterior.pairs log P(j | i, z), plus prior.counts for every log T_ij and normal priors on
/// weights and memory. The function takes one Newton step on this concave objective (McCullagh & Nelder 1989, section
/// 5.2), halved until the objective rises. With this generalised maximisation (Dempster, Laird & Rubin 1977) the
/// likelihood never falls. Returns the gain [nats].
double raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                       const SwitchingPrior& prior, SwitchingRegression& model);

}  // namespace modebank
