#pragma once

#include <vector>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Flags the windows (M) that contain a switch of mode. A window with two modes fits neither mode, so its residual
/// variance is significantly larger than that of both neighbours. The neighbours are the nearest windows before and
/// after it in its run that share no transition with it. Significant means that the ratio is above the 99 % quantile of
/// F(L - q, L - q), in any state. Windows without a neighbour on one side, and windows of L <= q, are never flagged.
/// Assumes that modes last at least two windows.
std::vector<bool> windows_over_switch(const WindowFits& fits);

}  // namespace modebank
