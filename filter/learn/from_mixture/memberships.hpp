#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Clusters windows by the features of the options (FeatureSet). The features may come from one-lag fits of the same
/// windows. `window`: the options of `fits`.
MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed);

/// Membership of each training transition in each mixture component, N x K. The row of a usable transition sums to one.
/// - Covered transition: the row is the mean responsibility of the clustered windows that cover the transition.
/// - Other transition: the row is that of the nearest clustered window of its run (the earlier one on a tie).
/// - Run without clustered windows: the row holds the mixture weights.
/// With a noise component the row excludes the probability of noise, so noise does not influence any mode. Rows of
/// unusable transitions are zero.
Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture);

}  // namespace modebank
