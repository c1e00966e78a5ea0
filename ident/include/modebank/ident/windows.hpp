#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/ident/motion_model.hpp"
#include "modebank/ident/options.hpp"

namespace modebank::ident {

/// Local models: the fits of M windows of n states with p parameters each. An element or column belongs to one window.
struct Windows {
  std::vector<std::string> parameter_names;  ///< p; for linear models A (row by row), B and c of each state in turn
  std::vector<std::ptrdiff_t> run;           ///< M, position of the window's run in RecordedRuns::runs
  std::vector<std::ptrdiff_t> begin;         ///< M, first sample of the window
  std::vector<std::ptrdiff_t> end;           ///< M, last sample of the window: begin + length
  Matrix theta;                              ///< p x M, estimates of theta
  Matrix covariance;                         ///< p*p x M, covariance of theta; NaN if rank deficient without a prior
  Matrix residual_sd;                        ///< n x M, standard deviation of the one-step residuals [state unit]
  std::vector<int> rank;             ///< M, rank of theta: number of directions that the window's data determine
  std::vector<FitStatus> status;     ///< M, how the fit ended
  std::vector<WindowSolver> solver;  ///< M, solver of the window: ceres or batch
  std::vector<double> prior_sd;      ///< p, standard deviations of the prior; empty without a prior
  std::vector<double> global_theta;  ///< p, least-squares estimate over all training runs; also the prior's mean
};

/// The names that FitOptions::model accepts: linear, varx and modebank's motion models.
std::vector<std::string> model_names();

/// Cuts and fits every window of the training runs, on all cores. The results equal those of `modebank run` for
/// any number of threads. Throws std::invalid_argument for an option out of range ("length = 0 is out of range: at
/// least 1") and for runs whose sizes do not fit. Throws DataError (modebank/base/error.hpp) if no run is long enough
/// for a window.
Windows fit_windows(const RecordedRuns& runs, const FitOptions& options = {});

/// fit_windows for the caller's own motion model. options.model is ignored, and the batch solver is not used. Several
/// threads call `model`.
Windows fit_windows(const RecordedRuns& runs, const FitOptions& options, const MotionModel& model);

}  // namespace modebank::ident
