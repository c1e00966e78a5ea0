#pragma once

#include <memory>

#include "ident/fit_options.hpp"
#include "ident/motion_model.hpp"

namespace modebank {

/// Whether FitOptions name one model that fits n states and m inputs. Throws ConfigurationError for lags of a model
/// that has none, residuals that the model does not have, an unknown model, and as make_motion_model does.
void check_model(const FitOptions& options, Index states, Index inputs);

/// The motion model that the options name; null for linear models.
std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs);

/// p of the model that the options name.
Index parameter_count(const FitOptions& options, Index states, Index inputs);

}  // namespace modebank
