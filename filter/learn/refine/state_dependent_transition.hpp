#pragma once

#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Decides whether transition probabilities depend on state and input (step/bank.hpp), and how strongly.
/// 1. Every start's fit with constant T continues as a logit on all training runs.
/// 2. The most likely of these fits is also tried with fewer modes, by merging one pair of modes after another.
///    These models then come from the same optimum. This matters because a logit has many separate optima. On one dead
///    zone, three modes that were fitted directly were 0.4 nats per sample worse than three that came from merging six.
/// 3. The most likely model of each number of modes continues without the left-out runs, first with the middle width
///    of the weights.
/// 4. The fewest modes that are as good as the best are chosen (fewest_modes_as_good), then their width.
/// Empty if is_worth_it rejects the gain over the chosen fit with constant T, or if no run can be left out. `stage`
/// records the result.
std::optional<Fit> choose_state_dependent_transition(const RefineInput& in, const CrossValidation& validation,
                                                     SwitchingStage& stage);

}  // namespace modebank
