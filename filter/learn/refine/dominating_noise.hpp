#pragma once

#include <optional>

#include "filter/learn/refine/training_fit.hpp"

namespace modebank {

/// A start for data dominated by measurement noise. There, theta of exact states is so biased (errors in variables)
/// that no search from it finds R. So the theta, Q and R of one linear model maximise the exact likelihood of the
/// training runs together, starting from R near the process noise of exact states. If R ends above Q, `bank` gets this
/// R and its share of Q, and every theta the shift of the one model's. Empty otherwise. `global`: least squares of
/// `recording`.
std::optional<Bank> start_of_dominating_noise(const RefineInput& in, const Recording& recording,
                                              const GlobalModel& global, const Bank& bank);

}  // namespace modebank
