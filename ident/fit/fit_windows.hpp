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

/// Cuts and fits every window of the training runs (in parallel on oneTBB; result i depends on window i and the global
/// model and prior alone). sigma is the window's robust_scale, or its run's (ScaleSource::run, and for L <= q), floored
/// by scale_floor. Who solves the windows, options.solver says; the batch solver's answers are audited.
/// The default prior is made from all full-rank windows, or from 200,000 windows drawn at random, 64 consecutive ones
/// at a time, where there are more. Throws DataError when there is no window: no training run has options.length
/// transitions; ConfigurationError for an option out of range or a solver that does not have the model.
WindowFits fit_windows(const Recording& recording, const FitOptions& options);

/// The windows of `fits`, which have lags, fitted with one lag each, otherwise as the options have it: window i is the
/// same transitions. Standard deviations of the prior that are given one per parameter are not used.
WindowFits fit_one_lag(const Recording& recording, const WindowFits& fits, FitOptions options);

/// Windows that fit_windows will return.
Index count_windows(const Recording& recording, const FitOptions& options);

/// The same fits in bounded memory: `sink` gets them in order, some ten thousand windows at a time, beginning with
/// index `first`; everything but the windows themselves is filled in each time, the audit up to there. Returns what
/// they have in common, without windows.
using WindowSink = std::function<void(const WindowFits& fits, Index first)>;
WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink);

/// The same for any motion model, through fit_model; searches start at the global model. Unexcited directions stay
/// there. The global model is the one-step one for both kinds of residuals. Throws as fit_windows does.
WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model);

/// The options with the name of a model that is handed over. Throws std::invalid_argument for the name of a linear one
/// and for other states or inputs than the recording's.
FitOptions options_for(const MotionModel& model, const Recording& recording, FitOptions options);

/// Whether FitOptions name one model that fits n states and m inputs. Throws ConfigurationError for lags of a model
/// that has none, residuals that the model does not have, an unknown model, and as make_motion_model does.
void check_model(const FitOptions& options, Index states, Index inputs);

/// Every model that options may name: linear, varx and the motion models.
std::vector<std::string> model_names();

/// The motion model that the options name; null for linear models.
std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs);

/// p of the model that the options name.
Index parameter_count(const FitOptions& options, Index states, Index inputs);

}  // namespace modebank
