#pragma once

#include <vector>

#include "ident/local_model.hpp"

namespace modebank {

/// Which windows straddle a switch of mode, M flags. A window that holds two modes fits neither: its residual variance
/// is significantly larger than that of both its neighbours, the nearest windows of its run that share no transition
/// with it and lie before and after. Significant: ratio above the 99 % quantile of F(L - q, L - q), in any state.
/// Windows without a neighbour on both sides, and windows of L <= q, are never flagged. Assumes that modes last for two
/// windows or more.
std::vector<bool> straddling_windows(const WindowFits& fits);

/// Which windows straddle a switch of mode by the labels of all windows (M, -1: none), M flags. A label is settled
/// where two windows without a shared transition lie in an unbroken row of it; shorter rows are windows in transit, but
/// those of less than half a window's length between rows of one label count as doubtful windows of it. Between two
/// settled rows there was a switch: all windows between are flagged, and at least 3/4 of a window's length to either
/// side of their middle. So are windows in transit at a run's ends. None is flagged when more than half of the labelled
/// windows would be: then labels do not last, and say nothing about switches.
std::vector<bool> windows_at_switches(const WindowFits& fits, const Eigen::VectorXi& labels);

}  // namespace modebank
