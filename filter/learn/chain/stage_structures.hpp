#pragma once

#include "filter/learn/chain/inputs.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// Chooses a structure for each stage among the structures that were compared. A linear model needs additional lags if
/// the motion is nonlinear or switches. Models that are nonlinear or switch themselves predict worse with these lags.
/// Marks rows of the table. Adds rows that are tested only here: one lag and two lags, with the found delay and with a
/// delay of one sample.
///
/// - One linear motion: takes the result of the search.
/// - `drifting`: decides by the causal score of a model with drifting coefficients. (The search's one-standard-error
///   rule is unstable over a few, different runs.) The condition is that this model predicts the training runs better
///   than the constant model, by 0.02 nats per sample. Candidates are the finalists of the search, and equal state and
///   input lags from 1 to 8. The fewest lags within 0.001 nats per sample (or 6 nats in all) of the highest score are
///   taken. With more than 20,000 training transitions the result of the search is kept.
/// - Modes, and one motion with switching noise: take the result of the search, unless one lag, two lags or the lags
///   of `drifting` gain (compare_structures).
void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found);

}  // namespace modebank
