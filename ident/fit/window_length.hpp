#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Smallest window length: enough for one lag of a few signals.
inline constexpr Index shortest_automatic_length = 25;

/// Window length in transitions for a model of q regressors and these training runs. It is 3 q, but at least
/// shortest_automatic_length. If modes seem to last less than three windows, it is 2 q or 1.5 q.
///
/// Modes count as short if the motion changes in more than one window in six. A change means that the one-lag models of
/// a window's halves differ significantly in coefficients (Chow 1960) or in residual variance. The test misses about
/// half of the switches, for example those near the ends of a window. If windows last a third of a mode's duration, the
/// test finds a change in 28 % of the windows.
Index automatic_length(const Recording& recording, const LinearStructure& structure);
/// automatic_length for the linear model, or the linearised motion model, that the options name.
Index automatic_length(const Recording& recording, const FitOptions& options);

/// Step between window starts that gives about 100,000 windows of the training runs; 1 if the runs have fewer windows.
/// A smaller step would add little, because neighbouring windows share most samples. A mixture compares its candidates
/// on fewer points.
Index automatic_step(const Recording& recording);

}  // namespace modebank
