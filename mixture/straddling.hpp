#pragma once

#include <vector>

#include "ident/model/local_model.hpp"

namespace modebank {

/// Which windows straddle a switch of mode, M flags. A window that holds two modes fits neither: its residual variance
/// is significantly larger than that of both its neighbours, the nearest windows of its run that share no transition
/// with it and lie before and after. Significant: ratio above the 99 % quantile of F(L - q, L - q), in any state.
/// Windows without a neighbour on both sides, and windows of L <= q, are never flagged. Assumes that modes last for two
/// windows or more.
std::vector<bool> straddling_windows(const WindowFits& fits);

}  // namespace modebank
