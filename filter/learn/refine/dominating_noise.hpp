#pragma once

#include <optional>

#include "filter/learn/refine/training_fit.hpp"

namespace modebank {

/// Where measurement noise dominates, theta of exact states is drawn so far to errors in variables that no search from
/// there finds R. One linear model then tells: its theta, Q and R together by the exact likelihood of the training
/// runs, from R of about what exact states take for process noise. Where that ends with R above Q: `bank` with its R
/// and its share of Q, and every theta moved as the one model's was. Empty otherwise. `global`: least squares of
/// `recording`.
std::optional<Bank> start_of_dominating_noise(const RefineInput& in, const Recording& recording,
                                              const GlobalModel& global, const Bank& bank);

}  // namespace modebank
