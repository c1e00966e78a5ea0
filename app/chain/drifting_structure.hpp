#pragma once

#include "app/chain/stage_inputs.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// A rule of one standard error over few runs that are unlike each other is unstable. Where a linear model whose
/// coefficients wander predicts the training runs better than the constant one, by 0.02 nats per sample, its causal
/// score of these runs chooses: among the finalists, and as many lags of the state as of the inputs, 1 to 8, with the
/// best delay. The fewest lags within 0.001 nats per sample, or 6 nats altogether, of the highest score are taken. All
/// are scored on the same samples. Of more than 20,000 training transitions nothing is asked: they are no few runs.
void let_drifting_choose(const Recording& recording, const StructureInputs& inputs, FoundStructure& found);

}  // namespace modebank
