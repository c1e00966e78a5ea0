#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// Smallest window length: enough for one lag of a few signals.
inline constexpr Index shortest_automatic_length = 25;

/// Window length in transitions for a model of q regressors and these training runs: 3 q, at least
/// shortest_automatic_length. The length is 2 q or 1.5 q if modes seem to last less than three windows.
///
/// The sign of short modes is a change of motion in more than one window in six. A change means that the one-lag models
/// of a window's halves differ significantly in coefficients (Chow 1960) or in residual variance. The test misses about
/// half of the switches, for example those near the ends of a window. With windows of a third of a mode's duration, it
/// finds a change in 28 % of the windows.
Index automatic_length(const Recording& recording, const LinearStructure& structure);
/// automatic_length for the linear model, or the linearised motion model, of these options.
Index automatic_length(const Recording& recording, const FitOptions& options);

/// Step between window starts that gives about 100,000 windows of the training runs; 1 if the runs have fewer windows.
/// Neighbouring windows share most samples, and a mixture compares its candidates on fewer points.
Index automatic_step(const Recording& recording);

}  // namespace modebank
