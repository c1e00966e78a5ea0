#pragma once

#include "ident/fit_options.hpp"
#include "ident/local_model.hpp"
#include "ident/motion_model.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// Least squares of one-step residuals over all training transitions, from the model's start values. Several states
/// weigh by the standard deviations of their residuals (three passes). Throws DataError without any transition.
GlobalModel fit_global(const Recording& recording, const MotionModel& model);

/// fit_windows for any model, through fit_model; searches start at the global model. Unexcited directions stay there.
/// The global model is the one-step one for both kinds of residuals. Throws as fit_windows does.
WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model);

}  // namespace modebank
