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

/// Which windows straddle a switch of mode by the labels of all windows (M, -1: none), M flags. A label is settled where
/// two windows without a shared transition lie in an unbroken row of it; shorter rows are windows in transit. Between
/// two settled rows of different labels there was a switch: all windows between are flagged, and at least one window's
/// length of them about the middle. Between two settled rows of one label they are flagged when they last for half a
/// window's length or more; shorter ones count as doubtful windows of that label. None is flagged when more than half of
/// the labelled windows would be: then labels do not last, and say nothing about switches.
std::vector<bool> windows_at_switches(const WindowFits& fits, const Eigen::VectorXi& labels);

}  // namespace modebank
