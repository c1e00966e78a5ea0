// The public API of window fits: converts between plain vectors and Eigen.
#include "ident/base/api.hpp"

#include "ident/data/public_recording.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/eigen.hpp"
#include "modebank/ident/windows.hpp"

namespace modebank::ident {

namespace {

Windows from_internal(const WindowFits& fits) {
  Windows windows;
  windows.parameter_names = fits.parameter_names();
  for (const Window& window : fits.windows) {
    windows.run.push_back(window.run);
    windows.begin.push_back(window.start);
    windows.end.push_back(window.start + fits.length);
  }
  windows.theta = to_matrix(fits.parameters);
  windows.covariance = to_matrix(fits.covariance);
  windows.residual_sd = to_matrix(fits.noise_variance.cwiseSqrt());
  windows.rank.assign(fits.rank.begin(), fits.rank.end());
  for (const int status : fits.status) windows.status.push_back(static_cast<FitStatus>(status));
  for (const char batch : fits.by_batch) windows.solver.push_back(batch ? WindowSolver::batch : WindowSolver::ceres);
  windows.prior_sd = to_vector(fits.prior_sd);
  windows.global_theta = to_vector(fits.global.theta);
  return windows;
}

}  // namespace

std::vector<std::string> model_names() { return modebank::model_names(); }

Windows fit_windows(const RecordedRuns& runs, const FitOptions& options) {
  return api_call([&] { return from_internal(modebank::fit_windows(to_recording(runs), options)); });
}

Windows fit_windows(const RecordedRuns& runs, const FitOptions& options, const MotionModel& model) {
  return api_call([&] {
    const Recording recording = to_recording(runs);
    return from_internal(modebank::fit_windows(recording, options_for(model, recording, options), model));
  });
}

}  // namespace modebank::ident
