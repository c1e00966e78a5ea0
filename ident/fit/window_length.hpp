#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Windows are as long as this at least, which is enough for one lag of a few signals.
inline constexpr Index shortest_automatic_length = 25;

/// Length of windows in transitions that suits a model of q regressors and the training runs: 3 q, at least
/// shortest_automatic_length. Where modes seem to last less than three windows it is 2 q, or 1.5 q.
///
/// Modes seem to last less where one window in six holds a change of motion. A change: the one-lag models of a window's
/// halves differ significantly, in coefficients (Chow 1960) or in residual variance. Such a test overlooks about half
/// of the switches, those near a window's ends among them, and of windows that last a third of a stay 28 % hold one.
Index automatic_length(const Recording& recording, const LinearStructure& structure);
/// The same for the linear model, or the linearised motion model, of these options.
Index automatic_length(const Recording& recording, const FitOptions& options);

}  // namespace modebank
