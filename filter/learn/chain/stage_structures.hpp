#pragma once

#include "filter/learn/chain/inputs.hpp"
#include "ident/lag/structure.hpp"

namespace modebank {

/// Each stage takes one of the structures that were compared: a linear model wants lags wherever motion bends or
/// switches, and what bends or switches loses with them. Marks rows of the table, and adds those that are asked about
/// alone: one lag and two, with the delay that was found and with that of one sample.
///
/// - One linear motion: as the search has it.
/// - `drifting`: a rule of one standard error over few runs that are unlike each other is unstable. Where a model whose
///   coefficients wander predicts the training runs better than the constant one, by 0.02 nats per sample, its causal
///   score of these runs chooses: among the finalists, and as many lags of the state as of the inputs, 1 to 8. The
///   fewest lags within 0.001 nats per sample, or 6 nats altogether, of the highest score are taken. Of more than
///   20,000 training transitions nothing is asked: they are no few runs.
/// - Modes, and one motion whose noise switches: as one linear motion, unless one lag, two or those of `drifting` gain
///   (compare_structures).
void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found);

}  // namespace modebank
