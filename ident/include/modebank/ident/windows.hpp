#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "modebank/base/recording.hpp"
#include "modebank/ident/motion_model.hpp"
#include "modebank/ident/options.hpp"
#include "modebank/ident/window_audit.hpp"

namespace modebank::ident {

/// Local models: the fits of M windows of n states, each with p parameters; one window per element or column.
struct Windows {
  std::vector<std::string> parameter_names;  ///< p; linear models: A (row by row), B, c of each state in turn
  std::vector<std::ptrdiff_t> run;           ///< M, position in RecordedRuns::runs
  std::vector<std::ptrdiff_t> begin;         ///< M, first sample of the window
  std::vector<std::ptrdiff_t> end;           ///< M, last sample of the window: begin + length
  Matrix theta;                              ///< p x M
  Matrix covariance;                         ///< p*p x M, of theta; NaN when rank deficient without a prior
  Matrix residual_sd;                        ///< n x M, of the one-step residuals [state unit]
  std::vector<int> rank;                     ///< M, of theta: how many directions the window's data determine
  std::vector<FitStatus> status;             ///< M, how the fit ended
  std::vector<WindowSolver> solver;          ///< M, who solved it: ceres or batch
  std::vector<double> prior_sd;              ///< p, the prior's standard deviations; empty without a prior
  std::vector<double> global_theta;          ///< p, least squares over all training runs; the prior's mean
  WindowAudit audit;                         ///< how many windows each solver solved, and to what tolerance
};

/// The models that FitOptions::model names: linear, varx and the motion models that modebank was built with.
std::vector<std::string> model_names();

/// Cuts and fits every window of the runs that are not held out, on all cores; the numbers are those of `modebank
/// identify`, and the same for any number of threads. Throws std::invalid_argument for an option
/// out of range ("length = 0 is out of range: at least 1") and for runs whose sizes do not fit, DataError
/// (modebank/base/error.hpp) where no run has the transitions of a window.
Windows fit_windows(const RecordedRuns& runs, const FitOptions& options = {});

/// The same for a motion model of one's own; options.model does not count, nor do the batch solver's windows. `model`
/// is called from several threads.
Windows fit_windows(const RecordedRuns& runs, const FitOptions& options, const MotionModel& model);

}  // namespace modebank::ident
