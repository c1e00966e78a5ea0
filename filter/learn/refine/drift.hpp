#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Decides whether the theta of each mode drifts within a run (equations/drift.hpp), at which rate, and how the noise
/// scale adapts. With `other_sizes` this is tried for the best fit of each number of modes, else only for the chosen
/// fit. The settings are searched on the grids of RefineTuning. The search maximises the score of left-out runs, one
/// setting after the other, until none gains. Among the numbers of modes, the fewest that are as good as the best are
/// chosen (fewest_modes_as_good).
/// Empty if the gain over the chosen fit without drift is not worth it (is_worth_it), or nothing can be left out.
/// `stage` records the result.
std::optional<Fit> choose_drift(const RefineInput& in, const CrossValidation& validation, const Fit& constant,
                                bool other_sizes, DriftStage& stage);

/// The bank with the fit's drift; R is then zero.
Bank with_drift(Bank bank, const Fit& fit);

}  // namespace modebank
