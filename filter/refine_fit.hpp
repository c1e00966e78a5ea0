#pragma once

#include <vector>

#include "filter/bank.hpp"
#include "filter/refine.hpp"
#include "filter/refine_validation.hpp"
#include "filter/switching_regression.hpp"
#include "filter/training_transitions.hpp"

namespace modebank {

/// A start fitted to the training runs.
struct TrainingFit {
  SwitchingRegression model;
  ModePosterior posterior;
  std::vector<ScreenedMode> screened;  ///< the frame's and those of the fit
  std::vector<double> objective;       ///< before each iteration until modes were screened
};

/// Expectation-maximisation from `start` for a number of iterations, or fewer if the objective stands still; then
/// starved, unstable and duplicate modes are taken out one by one, each time with some more iterations for the others.
TrainingFit fit_training_runs(const Bank& frame, const RefineStart& start, const TrainingTransitions& transitions,
                              const SwitchingPrior& prior, const RefineOptions& options, Index iterations);

}  // namespace modebank
