#pragma once

#include <Eigen/Core>

#include "ident/model/local_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Of each component's windows the share that seem to straddle a switch of mode, K: those that straddling_windows
/// flags, and those in stretches of one label that end before a window without a transition of the stretch's
/// predecessor could begin. Where modes last for two windows or more only mixed windows come and go that fast. 0 for a
/// component without windows.
Eigen::VectorXd passing_shares(const WindowFits& fits, const MixtureResult& mixture);

}  // namespace modebank
