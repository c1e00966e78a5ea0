#pragma once

#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Decides whether transition probabilities depend on state and input (transition_logit.hpp), and how strongly.
/// Every start's fit with constant T continues as a logit on all training runs. The most likely of these is also tried
/// with one pair of modes after another merged, so that fewer modes come from the same optimum. This matters because a
/// logit has more separate optima. On one dead zone, three modes found alone were 0.4 nats per sample worse than three
/// merged from six.
/// The most likely model of each number of modes then continues without the left-out runs, first with the middle width
/// of the weights. The fewest modes that are as good as the best are chosen (fewest_modes_as_good), then their width.
/// Empty if the gain over the chosen fit with constant T is not worth it (is_worth_it), or nothing can be left out.
/// `stage` records the result.
std::optional<Fit> choose_state_dependent_transition(const RefineInput& in, const CrossValidation& validation,
                                                     SwitchingStage& stage);

}  // namespace modebank
