#pragma once

#include <cstdint>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/regression.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

struct SwitchingEmOptions {
  bool one_theta = false;   ///< whether all modes share theta and differ only in Q
  double tolerance = 1e-6;  ///< nats per transition; the fit has converged if the objective gains less
  int alternations = 3;     ///< alternations between theta and Q in one maximisation
};

/// The model with the largest expected log posterior near `model`. The sums must come from the parameters of `model`. A
/// few alternations maximise over theta given Q, and over Q given theta (ECM: Meng & Rubin 1993). T and initial
/// probabilities are exact, except T of a logit (logit.hpp).
SwitchingRegression maximise(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
                             const SwitchingEmOptions& options, SwitchingRegression model);

/// Expectation-maximisation of the switching regression on one set of runs, iteration by iteration. Holds references to
/// the transitions and the prior.
class ExpectationMaximisation {
 public:
  ExpectationMaximisation(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                          const SwitchingEmOptions& options, SwitchingRegression start);

  /// Makes one iteration. After convergence it has no effect.
  void step();

  bool converged() const { return converged_; }
  const SwitchingRegression& model() const { return model_; }
  const ModePosterior& posterior() const { return posterior_; }
  const std::vector<double>& objective() const { return objective_; }  ///< objective before each iteration

 private:
  const TrainingTransitions& transitions_;
  const SwitchingPrior& prior_;
  SwitchingEmOptions options_;
  SwitchingRegression model_;
  ModePosterior posterior_;
  std::vector<double> objective_;
  bool converged_ = false;
};

/// The prior described in refine.hpp. `prior_sd`: p standard deviations, or empty. Throws DataError if the residual
/// covariance of the global model is singular.
SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions);

/// A start with `modes` modes. Each mode is fitted to a random stretch of `length` transitions, with the prior.
/// Stretches do not overlap if there is room. The transition matrix favours staying. Restart `index` derives its
/// generator from the seed.
SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index);

}  // namespace modebank
