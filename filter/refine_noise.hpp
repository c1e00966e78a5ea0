#pragma once

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// R (diagonal) by maximum likelihood: maximises the filter's likelihood of the training runs over R and one factor on
/// every Q (which held the measurement noise before), theta and T as they are, with ceres::GradientProblemSolver over
/// logarithms. The bank keeps its R, and says so by an empty R_standard_error, unless another is better by more than
/// `least_likelihood_gain` nats per sample; else R_standard_error comes from the curvature at the maximum. The IMM's
/// likelihood is itself approximate for R > 0.
void estimate_measurement_noise(const Recording& recording, const FilterOptions& filter, Bank& bank);

/// Less would not survive on other runs.
inline constexpr double least_likelihood_gain = 1e-3;

}  // namespace modebank
