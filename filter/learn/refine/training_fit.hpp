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

/// Inputs of the refinement of a bank. Holds references to the inputs.
struct RefineInput {
  const Recording& recording;
  const WindowFits& fits;
  const Bank& frame;  ///< the parts of the bank that are not refined
  const TrainingTransitions& transitions;
  const RefineOptions& options;
  const FilterOptions& filter;

  SwitchingPrior prior(double noise_transitions) const;
  /// The prior of a start, including its weight towards one motion.
  SwitchingPrior prior(const RefineStart& start) const;
};

SwitchingEmOptions em_options(const RefineOptions& options);

/// Expectation-maximisation on all training runs.
struct TrainingFit {
  SwitchingRegression model;
  ModePosterior posterior;
  std::vector<ScreenedMode> screened;  ///< modes removed from the frame and from the fit
  std::vector<double> objective;       ///< penalised log-likelihood before each iteration, until modes are removed
};

/// Runs expectation-maximisation from `model` for a number of iterations, or fewer if the objective converges. Then
/// removes starved, unstable and duplicate modes one by one. A few more iterations follow each removal.
TrainingFit fit_training_runs(const RefineInput& in, const SwitchingRegression& model, const SwitchingPrior& prior,
                              Index iterations);

/// The fit as a bank, without standard errors. The weight of a mode is its share of the transitions.
Bank bank_of_fit(const RefineInput& in, const TrainingFit& fit);

/// The bank of this fit with standard errors (likelihood/standard_errors.hpp), in the filter whose likelihood the fit
/// maximises (learning_filter). `estimated_R`: whether R is among the estimated parameters.
Bank with_errors(const RefineInput& in, const TrainingFit& fit, const SwitchingPrior& prior, bool estimated_R,
                 const Bank& bank);

/// The smallest R in refinement, n_y. It is negligible.
Eigen::VectorXd least_measurement_noise(const WindowFits& fits, const RefineTuning& tuning);

/// The filter whose likelihood is maximised with measurement noise, whatever the variant of the bank's filter.
inline constexpr FilterOptions learning_filter{FilterVariant::imm};

}  // namespace modebank
