#pragma once

#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// A number of modes whose switches see state and input, as cross-validation chose it.
struct Guards {
  ScoredFit fit;     ///< start: of the fit with a constant T that it goes on from; banks: with the logit
  double width = 0;  ///< prior standard deviation of the weights in units of the regressors' spread
  Index iterations = 0;
};

/// Whether switches see state and input (transition_logit.hpp), and how clearly. For each number of modes the best fit
/// with a constant T goes on as a logit, on every split from that split's own fit, first with the weights' middle
/// width; of the numbers of modes the fewest that are as good are chosen (fewest_modes_as_good), and for these the
/// width. Empty where the runs left out do not gain more than one standard error and least_gain over the chosen fit
/// with a constant T, which is the case of no weights, and where nothing can be left out. `stage` says what was found.
std::optional<Guards> choose_guards(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage);

/// The fit to all training runs with a constant T, taken on as a logit; or that of a split, where it leads to a clearly
/// (least_gain) likelier one. With a guard the optima of expectation-maximisation lie further apart than without: of
/// ten draws of a dead zone one ended 0.3 nats per sample below the others.
TrainingFit fit_guards(const RefineInput& in, const Guards& guards, const SwitchingPrior& prior,
                       const TrainingFit& constant);

}  // namespace modebank
