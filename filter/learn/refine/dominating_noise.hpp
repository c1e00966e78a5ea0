#pragma once

#include <optional>

#include "filter/learn/refine/training_fit.hpp"

namespace modebank {

/// A start for data that are mostly measurement noise. With such data, theta of exact states is so biased (errors in
/// variables) that no search from it finds R. So the exact likelihood of the training runs is maximised over theta, Q
/// and R of one linear model together. This search starts from R near the process noise of exact states. If R ends
/// above Q, `bank` gets this R and its share of Q, and every theta is shifted by the change of the one model's theta.
/// Otherwise the result is empty. `global`: least squares of `recording`.
std::optional<Bank> start_of_dominating_noise(const RefineInput& in, const Recording& recording,
                                              const GlobalModel& global, const Bank& bank);

}  // namespace modebank
