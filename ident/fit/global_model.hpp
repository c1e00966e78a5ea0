#pragma once

#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Plain least squares over all transitions of the training runs. Throws DataError when they cannot identify theta
/// at all (no transition); a rank-deficient regressor gives the minimum-norm solution. Sample weights make it weighted
/// least squares, N the number of transitions of positive weight.
GlobalModel fit_global(const Recording& recording, const LinearStructure& structure);

/// Least squares of one-step residuals over all training transitions, from the model's start values. Several states
/// weigh by the standard deviations of their residuals (three passes). Throws DataError without any transition.
GlobalModel fit_global(const Recording& recording, const MotionModel& model);

}  // namespace modebank
