#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Decides whether the theta of each mode drifts within a run (equations/drift.hpp). Also decides the rate of the drift
/// and the adaptation of the noise scale. With `other_sizes`, drift is tried for the best fit of each number of modes,
/// else only for the chosen fit. The settings are searched on the grids of RefineTuning. The search maximises the score
/// of left-out runs, one setting after the other, until no setting gains. Then the fewest modes that are as good as the
/// best are chosen (fewest_modes_as_good). Empty if is_worth_it rejects the gain over the chosen fit without drift, or
/// if no run can be left out. `stage` records the result.
std::optional<Fit> choose_drift(const RefineInput& in, const CrossValidation& validation, const Fit& constant,
                                bool other_sizes, DriftStage& stage);

/// The bank with the drift of the fit; R is then zero.
Bank with_drift(Bank bank, const Fit& fit);

}  // namespace modebank
