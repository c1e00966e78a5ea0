#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/switching/regression.hpp"
#include "modebank/learn/results.hpp"

/// Transition probabilities that depend on state and input (TransitionLogit): a multinomial logit of the
/// regressors (x, v), with a row of offsets for each previous mode.
namespace modebank {

/// A logit without effect, as a start for expectation-maximisation. Its reference is the mean of the regressors (x, v)
/// over the usable transitions.
TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes);

/// The prior, with a normal prior of the logit's weights about zero. `width`: standard deviation of the weights in
/// units of the regressors' standard deviation over the usable transitions; 0 means constant T. The weight of a
/// regressor that is constant up to rounding has no effect.
SwitchingPrior with_logit_prior(SwitchingPrior prior, const TrainingTransitions& transitions, double width);

/// Raises the expected log posterior of the switches over T and the logit's weights together. The objective is the sum
/// over transitions of posterior.pairs log P(j | i, z), plus prior.counts for every log T_ij and the prior of the
/// weights. The function takes one Newton step on this concave objective (McCullagh & Nelder 1989, section 5.2), halved
/// until the objective rises. With this generalised maximisation (Dempster, Laird & Rubin 1977) the likelihood never
/// falls. Returns the gain [nats].
double raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                       const SwitchingPrior& prior, SwitchingRegression& model);

/// Decides whether transition probabilities depend on state and input, and how strongly.
/// 1. Every start's fit with constant T continues as a logit on all training runs.
/// 2. The most likely of these fits is also tried with fewer modes, by merging one pair of modes after another.
///    These models then come from the same optimum. This matters because a logit has many separate optima. On one dead
///    zone, three modes that were fitted directly were 0.4 nats per sample worse than three that came from merging six.
/// 3. The most likely model of each number of modes continues without the left-out runs, first with the smaller width
///    of the weights.
/// 4. The fewest modes that are as good as the best are chosen (fewest_modes_as_good), then their width.
/// Empty if is_worth_it rejects the gain over the chosen fit with constant T, or if no run can be left out. `stage`
/// records the result.
std::optional<Fit> choose_logit(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage);

}  // namespace modebank
