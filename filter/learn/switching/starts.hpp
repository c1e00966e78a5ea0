#pragma once

#include <cstdint>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/switching/switching_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// The prior described in refine.hpp. `prior_sd`: p standard deviations, or empty.
SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions,
                               const RefineTuning& tuning = {});

/// Average information of one transition about theta, for residuals of covariance Q, p x p. The share
/// `least_information` of its largest entry is added to make it definite. Throws DataError if Q is singular.
Eigen::MatrixXd unit_information(const TrainingTransitions& transitions, const Eigen::MatrixXd& Q,
                                 double least_information);

/// The prior with every mode's theta shrunk towards one motion. theta is normal about the theta that all modes of
/// `model` would share, fitted to these transitions. The prior has the information of `theta_transitions` additional
/// transitions. With 0 the prior does not change. With infinity all modes share theta and differ only in noise.
SwitchingPrior towards_one_motion(SwitchingPrior prior, const TrainingTransitions& transitions,
                                  SwitchingRegression model, double theta_transitions, const RefineTuning& tuning);

/// A start with `modes` modes. Each mode is fitted to a random stretch of `length` transitions, with the prior.
/// Stretches do not overlap if there is room. The transition matrix favours staying. Restart `index` derives its
/// generator from the seed.
SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index,
                                         const RefineTuning& tuning = {});

}  // namespace modebank
