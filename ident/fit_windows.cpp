#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ident/error.hpp"
#include "ident/fit_transitions.hpp"
#include "ident/parameter_prior.hpp"
#include "ident/robust_scale.hpp"

namespace modebank {

namespace {

void check_options(const FitOptions& options, Index parameters) {
  const auto require = [](bool ok, const std::string& key, const std::string& value, const std::string& range) {
    if (!ok) throw ConfigurationError(key + " = " + value + " is out of range: " + range);
  };
  require(options.length >= 1, "window.length", std::to_string(options.length), "at least 1");
  require(options.step >= 1, "window.step", std::to_string(options.step), "at least 1");
  require(options.loss_scale >= 0.0 && std::isfinite(options.loss_scale), "window.loss_scale",
          std::to_string(options.loss_scale), "positive, or 0 for the default");
  require(options.max_iterations >= 1, "window.max_iterations", std::to_string(options.max_iterations), "at least 1");
  if (options.scale == ScaleSource::fixed)
    require(options.sigma > 0.0 && std::isfinite(options.sigma), "window.sigma", std::to_string(options.sigma),
            "positive");
  const Eigen::VectorXd& sd = options.prior_sd;
  require(sd.size() <= 1 || sd.size() == parameters, "window.prior_sd", std::to_string(sd.size()) + " values",
          "one value, or one per parameter (" + std::to_string(parameters) + ")");
  for (const double value : sd)
    require(value > 0.0 && std::isfinite(value), "window.prior_sd", std::to_string(value), "positive");
}

/// Everything that the fits of all windows share.
struct Context {
  const Recording& recording;
  const FitOptions& options;
  const GlobalModel& global;
  Estimator estimator;
  Eigen::VectorXd floor;                   ///< n, least sigma
  std::vector<Eigen::VectorXd> run_scale;  ///< sigma of each training run, n; empty for other runs
};

/// sigma of a whole run; a run too short to tell has the global one.
Eigen::VectorXd run_scale(const Trajectory& run, const GlobalModel& global, const LinearStructure& structure,
                          const Eigen::VectorXd& floor) {
  const Transitions transitions = finite_rows(stack_transitions(run, 0, run.transitions(), structure));
  const Eigen::VectorXd scale = robust_scale(transitions, decompose(transitions.regressors, excitation_tolerance));
  const Eigen::VectorXd& usable = scale.allFinite() ? scale : Eigen::VectorXd(global.noise_variance().cwiseSqrt());
  return usable.cwiseMax(floor);
}

Context make_context(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                     const GlobalModel& global) {
  const Eigen::VectorXd floor = scale_floor(stack_training(recording, structure), global.noise_variance());
  Context context{recording, options, global, make_estimator(structure, options), floor, {}};
  for (const Trajectory& run : recording.runs)
    context.run_scale.push_back(run.role == Role::train ? run_scale(run, global, structure, floor) : Eigen::VectorXd());
  return context;
}

Eigen::VectorXd window_sigma(const Context& context, const Window& window, const Transitions& transitions,
                             const Decomposition& decomposition) {
  if (context.options.scale == ScaleSource::fixed)
    return Eigen::VectorXd::Constant(transitions.increments.cols(), context.options.sigma);
  const bool whole_run =
      context.options.scale == ScaleSource::run || transitions.count() <= transitions.regressors.cols();
  if (whole_run) return context.run_scale[static_cast<std::size_t>(window.run)];
  return robust_scale(transitions, decomposition).cwiseMax(context.floor);
}

/// A window's data on the way to its fit.
struct WindowData {
  Transitions transitions;
  Decomposition decomposition;
  NoiseScale scale;
};

/// Transitions with a NaN or infinity are left out; nothing when none is left.
std::optional<WindowData> load(const Context& context, const Window& window) {
  const Trajectory& run = context.recording.runs[static_cast<std::size_t>(window.run)];
  const LinearStructure& structure = context.estimator.structure;
  Transitions transitions = finite_rows(stack_transitions(run, window.start, context.options.length, structure));
  if (transitions.count() == 0) return std::nullopt;
  Decomposition decomposition = decompose(transitions.regressors, excitation_tolerance);
  Eigen::VectorXd sigma = window_sigma(context, window, transitions, decomposition);
  return WindowData{std::move(transitions), std::move(decomposition), {std::move(sigma), context.floor}};
}

LocalModel fit_one(const Context& context, const Window& window, const ParameterPrior* prior) {
  const std::optional<WindowData> data = load(context, window);
  if (!data) return failed_fit(context.estimator.structure);
  return fit_transitions(data->transitions, data->decomposition, context.estimator, data->scale, prior);
}

template <class Body>
void for_each_window(const std::vector<Window>& windows, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<Index>(0, static_cast<Index>(windows.size())),
                    [&](const tbb::blocked_range<Index>& range) {
                      for (Index i = range.begin(); i < range.end(); ++i) body(i, windows[static_cast<std::size_t>(i)]);
                    });
}

/// theta of the full-rank windows fitted without prior, one per column.
Eigen::MatrixXd unregularised_fits(const Context& context, const std::vector<Window>& windows) {
  const Index M = static_cast<Index>(windows.size());
  Eigen::MatrixXd all = Eigen::MatrixXd::Constant(context.global.theta.size(), M, std::nan(""));
  for_each_window(windows, [&](Index i, const Window& window) {
    const std::optional<WindowData> data = load(context, window);
    if (!data || data->decomposition.rank() < context.estimator.structure.regressors()) return;
    all.col(i) = fit_theta(data->transitions, data->decomposition, context.estimator, data->scale, nullptr);
  });
  std::vector<Index> fitted;
  for (Index i = 0; i < M; ++i)
    if (all.col(i).allFinite()) fitted.push_back(i);
  return all(Eigen::all, fitted);
}

Eigen::VectorXd prior_sd(const Context& context, const std::vector<Window>& windows) {
  const Eigen::VectorXd& given = context.options.prior_sd;
  const Index p = context.global.theta.size();
  if (given.size() == p) return given;
  if (given.size() == 1) return Eigen::VectorXd::Constant(p, given(0));
  return default_prior_sd(unregularised_fits(context, windows), context.global, context.options.length);
}

}  // namespace

WindowFits fit_windows(const Recording& recording, const FitOptions& options) {
  const LinearStructure structure{recording.state_count(), recording.input_count(), options.intercept};
  check_options(options, structure.parameters());
  WindowFits fits;
  fits.structure = structure;
  fits.length = options.length;
  fits.step = options.step;
  fits.loss = options.loss;
  fits.windows = make_windows(recording, options.length, options.step);
  if (fits.windows.empty())
    throw DataError("no training run has the " + std::to_string(options.length) + " transitions of a window");
  fits.global = fit_global(recording, structure);

  const Context context = make_context(recording, options, structure, fits.global);
  std::optional<ParameterPrior> prior;
  if (options.prior == Prior::global) {
    fits.prior_sd = prior_sd(context, fits.windows);
    prior = ParameterPrior{fits.global.theta, fits.prior_sd};
  }
  fits.resize(fits.count());
  for_each_window(fits.windows, [&](Index i, const Window& window) {
    fits.set(i, fit_one(context, window, prior ? &*prior : nullptr));
  });
  return fits;
}

}  // namespace modebank
