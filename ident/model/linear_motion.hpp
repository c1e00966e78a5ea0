#pragma once

#include <memory>

#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// The linear increment model (without lags) as a MotionModel, for what only those do: simulation
/// residuals. It starts at theta = 0: the state stays.
std::shared_ptr<const MotionModel> make_linear_motion(const LinearStructure& structure);

}  // namespace modebank
