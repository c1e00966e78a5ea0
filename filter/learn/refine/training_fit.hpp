#pragma once

#include <string>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"
#include "modebank/filter/options.hpp"

namespace modebank {

/// What a bank is refined from, and how. Keeps references.
struct RefineInput {
  const Recording& recording;
  const WindowFits& fits;
  const Bank& frame;  ///< everything that is not refined
  const TrainingTransitions& transitions;
  const RefineOptions& options;
  const FilterOptions& filter;

  SwitchingPrior prior(double noise_transitions) const;
  /// Of a start, with its pull towards one motion.
  SwitchingPrior prior(const RefineStart& start) const;
};

SwitchingEmOptions em_options(const RefineOptions& options);

/// Expectation-maximisation on all training runs.
struct TrainingFit {
  SwitchingRegression model;
  ModePosterior posterior;
  std::vector<ScreenedMode> screened;  ///< the frame's and those of the fit
  std::vector<double> objective;       ///< before each iteration until modes were screened
  Shrinking shrinking = {};            ///< of the model as it stands
};

/// Expectation-maximisation from `model` for a number of iterations, or fewer if the objective stands still; then
/// starved, unstable and duplicate modes are taken out one by one, each time with some more iterations for the others.
TrainingFit fit_training_runs(const RefineInput& in, const SwitchingRegression& model, const SwitchingPrior& prior,
                              Index iterations);

/// The fit as a bank, its modes weighted by their shares of the transitions. Standard errors are not known yet.
Bank bank_of_fit(const RefineInput& in, const TrainingFit& fit, const NoiseAdaptation& adaptation);

/// The bank that this fit led to (with_standard_errors: likelihood/standard_errors.hpp) in the filter whose likelihood
/// it maximises, exact_filter's or learning_filter's. `estimated_R`: R is among what was estimated.
Bank with_errors(const RefineInput& in, const TrainingFit& fit, const SwitchingPrior& prior, bool estimated_R,
                 const FilterOptions& filter, const Bank& bank);

/// The least R that refinement knows: as good as none. n_y.
Eigen::VectorXd least_measurement_noise(const WindowFits& fits, const RefineTuning& tuning);

/// The filter whose likelihood is maximised once there is measurement noise: as the bank will be run, but an IMM with
/// known parameters.
FilterOptions learning_filter(const FilterOptions& filter);

/// The filter whose likelihood expectation-maximisation raises: the same with every run as rough as the others. Errors
/// in an adaptive one would be those of an estimate that weighs rough runs less, which this is not: over draws of runs
/// with sd 0.4 and 2 they are half of what theta is off by (standard_errors_test.cpp).
FilterOptions exact_filter(const FilterOptions& filter);

}  // namespace modebank
