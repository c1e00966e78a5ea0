#include "ident/fit/detail/batch/windows.hpp"

#include <string>

#include "modebank/base/error.hpp"

namespace modebank {

std::unique_ptr<BatchWindows> BatchWindows::make(const LinearWindows& windows, Index count,
                                                 const ParameterPrior* prior) {
  const FitOptions& options = windows.options();
  const bool possible = BatchSolver::handles(windows.structure(), options.length);
  if (options.solver == WindowSolver::batch && !possible)
    throw ConfigurationError("solver = batch fits linear models of one state with at most " +
                             std::to_string(batch::max_regressors) +
                             " regressors, fewer than the window's length; use auto or ceres");
  const bool wanted = options.solver == WindowSolver::batch ||
                      (options.solver == WindowSolver::automatic && count > most_ceres_windows);
  return possible && wanted ? std::unique_ptr<BatchWindows>(new BatchWindows(windows, prior)) : nullptr;
}

BatchWindows::BatchWindows(const LinearWindows& windows, const ParameterPrior* prior)
    : windows_(windows), solver_(batch_settings(windows.structure(), windows.options(), prior, windows.floor()(0))) {}

const std::vector<batch::Verdict>& BatchWindows::solve(const WindowPlan::Range& range, batch::Output out) {
  Worker& worker = workers_.local();
  const batch::Settings& settings = solver_.settings();
  const batch::Chunk chunk = worker.workspace.stage(windows_.run_of(range.window), range.window.start, range.count,
                                                    windows_.structure(), settings);
  out.verdict = worker.verdict.data();
  solver_(chunk, worker.workspace.scratch(settings.length), out);
  return worker.verdict;
}

batch::Output columns_from(WindowFits& fits, Index i) {
  return {.theta = fits.parameters.col(i).data(),
          .covariance = fits.covariance.col(i).data(),
          .noise_variance = fits.noise_variance.col(i).data(),
          .condition = fits.condition.data() + i,
          .information = fits.information.col(i).data(),
          .inlier_fraction = fits.inlier_fraction.data() + i,
          .r_squared = fits.r_squared.col(i).data(),
          .weighed_information = fits.weighed_information.col(i).data(),
          .transitions = fits.transitions.data() + i,
          .rank = fits.rank.data() + i,
          .status = fits.status.data() + i};
}

}  // namespace modebank
