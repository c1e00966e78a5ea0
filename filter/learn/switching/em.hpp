#pragma once

#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/switching_regression.hpp"

namespace modebank {

struct SwitchingEmOptions {
  bool one_theta = false;   ///< all modes have the same theta, and differ in Q
  double tolerance = 1e-6;  ///< nats per transition: the objective stands still when it gains less
  int alternations = 3;     ///< of theta and Q in one maximisation
};

/// The model with the largest expected log posterior near `model`, whose parameters the sums were computed with: theta
/// given Q, then Q given theta, a few times each (ECM: Meng & Rubin 1993), T and initial probabilities exactly; T of a
/// logit is not among them (transition_regression.hpp).
SwitchingRegression maximise(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
                             const SwitchingEmOptions& options, SwitchingRegression model);

/// Expectation-maximisation of the switching regression on one set of runs, iteration by iteration. Keeps references
/// to the transitions and the prior.
class ExpectationMaximisation {
 public:
  ExpectationMaximisation(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                          const SwitchingEmOptions& options, SwitchingRegression start);

  /// One iteration; does nothing once the objective stands still.
  void step();

  bool converged() const { return converged_; }
  const SwitchingRegression& model() const { return model_; }
  const ModePosterior& posterior() const { return posterior_; }
  const std::vector<double>& objective() const { return objective_; }  ///< before each iteration

 private:
  const TrainingTransitions& transitions_;
  const SwitchingPrior& prior_;
  SwitchingEmOptions options_;
  SwitchingRegression model_;
  ModePosterior posterior_;
  std::vector<double> objective_;
  bool converged_ = false;
};

}  // namespace modebank
