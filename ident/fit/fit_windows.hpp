#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ident/data/trajectory.hpp"
#include "ident/fit/options.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Cuts and fits every window of the training runs, in parallel on oneTBB. Result i depends only on window i, the
/// global model and the prior. sigma is the robust_scale of the window. If L <= q, it is the
/// robust_scale of the run. It is at least scale_floor. options.solver selects the solver. The default prior comes from
/// all full-rank windows, or from 200,000 randomly drawn windows (64 consecutive windows at a time) if there are more.
/// Throws DataError if no training run has options.length transitions. Throws ConfigurationError for an option out of
/// range or a solver that does not support the model.
WindowFits fit_windows(const Recording& recording, const FitOptions& options);

/// Fits the windows of `fits`, a model with several lags, again with a one-lag model. All other options are the same.
/// Window i covers the same transitions. Prior standard deviations that are given per parameter are ignored.
WindowFits fit_one_lag(const Recording& recording, const WindowFits& fits, FitOptions options);

/// Number of windows that fit_windows will return.
Index count_windows(const Recording& recording, const FitOptions& options);

/// fit_windows in bounded memory. Passes the windows to `sink` in order, some ten thousand per call, from index `first`
/// on. Each call fills all other fields. Returns the common fields
/// without windows.
using WindowSink = std::function<void(const WindowFits& fits, Index first)>;
WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink);

/// fit_windows for any motion model, through fit_model. Searches start at the global model, and directions without
/// excitation stay there. The global model always uses one-step residuals. Throws the errors of fit_windows.
WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model);

/// The options with the name of the given model. Throws std::invalid_argument for the name of a linear model. Also
/// throws it if the states or inputs differ from those of the recording.
FitOptions options_for(const MotionModel& model, const Recording& recording, FitOptions options);

/// Throws ConfigurationError unless the options name one model that fits n states and m inputs. ConfigurationError is
/// also thrown for an unknown model, for lags of a model without lags, and for residuals that the model lacks. Also
/// throws the errors of make_motion_model.
void check_model(const FitOptions& options, Index states, Index inputs);

/// All model names that the options accept: linear, varx and the motion models.
std::vector<std::string> model_names();

/// The motion model that the options name; null for linear models.
std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs);

/// Number of parameters p of the model that the options name.
Index parameter_count(const FitOptions& options, Index states, Index inputs);

}  // namespace modebank
