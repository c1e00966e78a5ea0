#pragma once

#include <Eigen/Core>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// How much each training transition belongs to each mixture component, N x K. Every usable transition enters once
/// (its row sums to one, or to its sample weight): the mean responsibility of the clustered windows that cover it;
/// where none does, the responsibility of the nearest clustered window of its run (the earlier of two equally near
/// ones); the mixture weights in runs without any clustered window. Of a mixture with a noise component the row lacks
/// the probability of noise: what is noise teaches no mode. Rows of unusable transitions are zero.
Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture);

}  // namespace modebank
