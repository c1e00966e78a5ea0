#pragma once

#include <optional>
#include <vector>

#include "filter/learn/refine/cross_validation.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Whether switches see state and input (transition_logit.hpp), and how clearly. Every start's fit with a constant T
/// goes on as a logit on all training runs, and the likeliest of these with one pair of modes after another merged, so
/// that fewer modes come from the same optimum: with a guard the optima lie further apart than without, and of one dead
/// zone three modes by themselves ended 0.4 nats per sample below three that six had been merged to. The likeliest of
/// each number of modes then goes on without the runs left out, first with the weights' middle width; the fewest modes
/// that are as good are chosen (fewest_modes_as_good), and for these the width. Empty where it is not worth it
/// (is_worth_it) against the chosen fit with a constant T, which is the case of no weights, and where nothing can be
/// left out. `stage` says what was found.
std::optional<Fit> choose_guards(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage);

}  // namespace modebank
