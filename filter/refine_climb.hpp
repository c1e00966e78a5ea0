#pragma once

#include <vector>

#include "filter/switching_regression.hpp"
#include "filter/training_transitions.hpp"

namespace modebank {

/// Expectation-maximisation of the switching regression on one set of runs, iteration by iteration. Keeps references
/// to the transitions and the prior.
class Climb {
 public:
  Climb(const TrainingTransitions& transitions, const SwitchingPrior& prior, SharedParts shared, double tolerance,
        SwitchingRegression start);

  /// One iteration; does nothing once the objective stands still.
  void step();

  bool converged() const { return converged_; }
  const SwitchingRegression& model() const { return model_; }
  const ModePosterior& posterior() const { return posterior_; }
  const std::vector<double>& objective() const { return objective_; }  ///< before each iteration

 private:
  const TrainingTransitions& transitions_;
  const SwitchingPrior& prior_;
  SharedParts shared_;
  double tolerance_;
  SwitchingRegression model_;
  ModePosterior posterior_;
  std::vector<double> objective_;
  bool converged_ = false;
};

}  // namespace modebank
