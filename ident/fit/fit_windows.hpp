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
/// global model and the prior. sigma is the robust_scale of the window, or that of its run (ScaleSource::run, and if L
/// <= q). It is at least scale_floor. options.solver selects the solver; the batch solver's results are audited. The
/// default prior comes from all full-rank windows, or from 200,000 randomly drawn ones (64 consecutive at a time) if
/// there are more. Throws DataError if no training run has options.length transitions. Throws ConfigurationError for an
/// option out of range or a solver that does not support the model.
WindowFits fit_windows(const Recording& recording, const FitOptions& options);

/// Fits the windows of `fits`, a model with lags, with one lag each and otherwise the same options. Window i covers the
/// same transitions. Prior standard deviations that are given per parameter are ignored.
WindowFits fit_one_lag(const Recording& recording, const WindowFits& fits, FitOptions options);

/// Number of windows that fit_windows will return.
Index count_windows(const Recording& recording, const FitOptions& options);

/// fit_windows in bounded memory. `sink` gets the windows in order, some ten thousand per call, starting at index
/// `first`. All other fields are filled on each call. The audit covers the windows up to that call. Returns the common
/// fields without windows.
using WindowSink = std::function<void(const WindowFits& fits, Index first)>;
WindowFits stream_windows(const Recording& recording, const FitOptions& options, const WindowSink& sink);

/// fit_windows for any motion model, through fit_model. Searches start at the global model, and directions without
/// excitation stay there. The global model always uses one-step residuals. Throws the errors of fit_windows.
WindowFits fit_windows(const Recording& recording, const FitOptions& options, const MotionModel& model);

/// The options with the name of the given model. Throws std::invalid_argument for the name of a linear model, and if
/// states or inputs differ from those of the recording.
FitOptions options_for(const MotionModel& model, const Recording& recording, FitOptions options);

/// Throws ConfigurationError unless FitOptions name one model that fits n states and m inputs. Examples of errors are
/// lags for a model without lags, residuals that the model lacks, and an unknown model. Also throws the errors of
/// make_motion_model.
void check_model(const FitOptions& options, Index states, Index inputs);

/// All model names that options accept: linear, varx and the motion models.
std::vector<std::string> model_names();

/// The motion model that the options name; null for linear models.
std::shared_ptr<const MotionModel> motion_model(const FitOptions& options, Index states, Index inputs);

/// Number of parameters p of the model in the options.
Index parameter_count(const FitOptions& options, Index states, Index inputs);

}  // namespace modebank
