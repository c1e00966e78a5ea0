#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Share of each component's windows that seem to contain a switch of mode, K. These are windows flagged by
/// windows_over_switch, and windows of short stretches. A stretch consists of successive windows with one label. It is
/// short if it ends before a window could begin that shares no transition with the previous stretch. If modes last at
/// least two windows, only mixed windows are that short. 0 for a component without windows.
Eigen::VectorXd passing_shares(const WindowFits& fits, const MixtureResult& mixture);

}  // namespace modebank
