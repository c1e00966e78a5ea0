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

/// From one window's start to the next so that training runs have about 100,000 windows: 1 where they have fewer.
/// Neighbours share most of their samples, and 100,000 are more than a mixture's candidates are compared on.
Index automatic_step(const Recording& recording);

}  // namespace modebank
