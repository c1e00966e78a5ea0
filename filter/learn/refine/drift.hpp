#pragma once

#include <optional>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Whether theta of each mode follows a run (equations/drift.hpp), how fast, and how the noise scale moves then. For
/// the best fit of each number of modes (`other_sizes`; else for `steady` alone) the settings of the highest score of
/// the runs left out are searched on the grids of RefineTuning, one after the other until none gains; of the numbers of
/// modes the fewest that are as good are chosen (fewest_modes_as_good). Empty where it is not worth it
/// (is_worth_it) against the chosen fit without drift, or where nothing can be left out. `stage`
/// says what was found.
std::optional<Fit> choose_drift(const RefineInput& in, const CrossValidation& validation, const Fit& steady,
                                bool other_sizes, DriftStage& stage);

/// The bank with its modes drifting as the fit's: R is zero then.
Bank with_drift(Bank bank, const Fit& fit);

}  // namespace modebank
