#include "ident/fit/window_fitter.hpp"

#include <utility>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/describe.hpp"

namespace modebank {

WindowFitter::WindowFitter(const Recording& recording, const FitOptions& options, const GlobalModel& global,
                           Eigen::VectorXd floor)
    : recording_(recording),
      options_(options),
      global_(global),
      floor_(std::move(floor)),
      run_scale_(std::make_unique<RunScale[]>(recording.runs.size())) {}

const Eigen::VectorXd& WindowFitter::run_scale(Index run) const {
  RunScale& scale = run_scale_[static_cast<std::size_t>(run)];
  std::call_once(scale.once, [&] {
    const Eigen::VectorXd own = scale_of(recording_.runs[static_cast<std::size_t>(run)]);
    const Eigen::VectorXd usable = own.allFinite() ? own : Eigen::VectorXd(global_.noise_variance().cwiseSqrt());
    scale.value = usable.cwiseMax(floor_);
  });
  return scale.value;
}

Eigen::VectorXd WindowFitter::window_sigma(const Window& window, bool enough,
                                           const std::function<Eigen::VectorXd()>& own) const {
  if (options_.sigma > 0.0) return Eigen::VectorXd::Constant(floor_.size(), options_.sigma);
  if (!enough) return run_scale(window.run);
  const Eigen::VectorXd scale = own();
  return scale.allFinite() ? Eigen::VectorXd(scale.cwiseMax(floor_)) : run_scale(window.run);
}

LinearWindows::LinearWindows(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                             const GlobalModel& global)
    : WindowFitter(recording, options, global, scale_floor(recording, structure, global.noise_variance())),
      estimator_(make_estimator(structure, options)) {}

Eigen::VectorXd LinearWindows::scale_of(const Trajectory& run) const {
  const Transitions t = finite_rows(stack_transitions(run, 0, run.transitions(), structure()));
  return robust_scale(t, decompose(t.regressors, excitation_tolerance));
}

std::optional<LinearWindows::WindowData> LinearWindows::load(const Window& window) const {
  Transitions transitions = finite_rows(stack_transitions(run_of(window), window.start, options().length, structure()));
  if (transitions.count() == 0) return std::nullopt;
  Decomposition decomposition = decompose(transitions.regressors, excitation_tolerance);
  Eigen::VectorXd sigma = window_sigma(window, transitions.count() > structure().regressors(),
                                       [&] { return robust_scale(transitions, decomposition); });
  return WindowData{std::move(transitions), std::move(decomposition), {std::move(sigma), floor()}};
}

LocalModel LinearWindows::fit(const Window& window, const ParameterPrior* prior) const {
  const std::optional<WindowData> data = load(window);
  if (!data) return failed_fit(structure().parameters(), structure().states);
  return fit_transitions(data->transitions, data->decomposition, estimator_, data->scale, prior);
}

Eigen::VectorXd LinearWindows::unregularised_theta(const Window& window) const {
  const std::optional<WindowData> data = load(window);
  if (!data || data->decomposition.rank() < structure().regressors())
    return Eigen::VectorXd::Constant(structure().parameters(), not_a_number);
  return fit_theta(data->transitions, data->decomposition, estimator_, data->scale, nullptr);
}

MotionWindows::MotionWindows(const Recording& recording, const FitOptions& options, const MotionModel& model,
                             const GlobalModel& global)
    : WindowFitter(recording, options, global,
                   scale_floor(recording, {model.states(), model.inputs(), false}, global.noise_variance())),
      model_(model),
      estimator_(make_model_estimator(model, options)),
      least_squares_(Loss::trivial, 0.0) {}

Eigen::VectorXd MotionWindows::least_squares_scale(const ModelResiduals& residuals,
                                                   const Eigen::VectorXd& sigma) const {
  const Index n = residuals.states();
  const ModelMinimum minimum =
      minimise_model(residuals, sigma, least_squares_, nullptr, estimator_.max_iterations, global().theta);
  if (minimum.status == FitStatus::failed) return Eigen::VectorXd::Constant(n, not_a_number);
  Eigen::VectorXd r;
  RowMajorJacobian J;
  residuals.evaluate(minimum.theta.data(), r, &J);
  const double lost = static_cast<double>(decompose(J, excitation_tolerance).rank()) / static_cast<double>(n);
  return robust_scale(r.reshaped(n, residuals.samples()).transpose(), lost);
}

Eigen::VectorXd MotionWindows::scale_of(const Trajectory& run) const {
  const ModelResiduals residuals(model_, {{&run, 0, run.transitions()}});
  if (residuals.samples() == 0) return Eigen::VectorXd::Constant(model_.states(), not_a_number);
  return least_squares_scale(residuals, global().noise_variance().cwiseSqrt().cwiseMax(floor()));
}

LocalModel MotionWindows::fit(const Window& window, const ParameterPrior* prior) const {
  const ModelResiduals residuals(model_, {{&run_of(window), window.start, options().length}});
  const Eigen::VectorXd sigma = window_sigma(window, residuals.rows() > residuals.unknowns(),
                                             [&] { return least_squares_scale(residuals, run_scale(window.run)); });
  return fit_model(residuals, estimator_, sigma, floor(), prior, global().theta);
}

Eigen::VectorXd MotionWindows::unregularised_theta(const Window& window) const {
  const LocalModel fit = this->fit(window, nullptr);
  const Index p = model_.parameter_count();
  return fit.rank == p ? fit.theta : Eigen::VectorXd::Constant(p, not_a_number);
}

}  // namespace modebank
