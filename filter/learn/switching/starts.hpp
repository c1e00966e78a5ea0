#pragma once

#include <cstdint>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// The prior that refine.hpp describes. `prior_sd`: p standard deviations, or empty.
SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions,
                               const RefineTuning& tuning = {});

/// p x p, information about theta that one transition carries on average where residuals have covariance Q, made
/// definite by `least_information` of its largest entry. Throws DataError where Q has no inverse.
Eigen::MatrixXd unit_information(const TrainingTransitions& transitions, const Eigen::MatrixXd& Q,
                                 double least_information);

/// `modes` modes, each the prior-regularised regression of a random stretch of `length` transitions, stretches drawn
/// without overlap where there is room; sticky transitions. Restart `index` derives its generator from the seed.
SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index,
                                         const RefineTuning& tuning = {});

}  // namespace modebank
