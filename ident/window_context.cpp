#include "ident/window_context.hpp"

#include <utility>

#include "ident/not_a_number.hpp"
#include "ident/robust_scale.hpp"

namespace modebank {

WindowContext::WindowContext(const Recording& recording, const FitOptions& options, const LinearStructure& structure,
                             const GlobalModel& global)
    : recording_(recording),
      options_(options),
      global_(global),
      estimator_(make_estimator(structure, options)),
      floor_(scale_floor(recording, structure, global.noise_variance())),
      run_scale_(std::make_unique<RunScale[]>(recording.runs.size())) {}

const Eigen::VectorXd& WindowContext::run_scale(Index run) const {
  RunScale& scale = run_scale_[static_cast<std::size_t>(run)];
  std::call_once(scale.once, [&] {
    const Trajectory& trajectory = recording_.runs[static_cast<std::size_t>(run)];
    const Transitions t = finite_rows(stack_transitions(trajectory, 0, trajectory.transitions(), structure()));
    const Eigen::VectorXd own = robust_scale(t, decompose(t.regressors, excitation_tolerance));
    const Eigen::VectorXd usable = own.allFinite() ? own : Eigen::VectorXd(global_.noise_variance().cwiseSqrt());
    scale.value = usable.cwiseMax(floor_);
  });
  return scale.value;
}

Eigen::VectorXd WindowContext::window_sigma(const Window& window, const Transitions& transitions,
                                            const Decomposition& decomposition) const {
  if (options_.scale == ScaleSource::fixed)
    return Eigen::VectorXd::Constant(transitions.increments.cols(), options_.sigma);
  const bool whole_run = options_.scale == ScaleSource::run || transitions.count() <= transitions.regressors.cols();
  if (whole_run) return run_scale(window.run);
  return robust_scale(transitions, decomposition).cwiseMax(floor_);
}

std::optional<WindowContext::WindowData> WindowContext::load(const Window& window) const {
  Transitions transitions = finite_rows(stack_transitions(run_of(window), window.start, options_.length, structure()));
  if (transitions.count() == 0) return std::nullopt;
  Decomposition decomposition = decompose(transitions.regressors, excitation_tolerance);
  Eigen::VectorXd sigma = window_sigma(window, transitions, decomposition);
  return WindowData{std::move(transitions), std::move(decomposition), {std::move(sigma), floor_}};
}

LocalModel WindowContext::fit(const Window& window, const ParameterPrior* prior) const {
  const std::optional<WindowData> data = load(window);
  if (!data) return failed_fit(structure());
  return fit_transitions(data->transitions, data->decomposition, estimator_, data->scale, prior);
}

Eigen::VectorXd WindowContext::unregularised_theta(const Window& window) const {
  const std::optional<WindowData> data = load(window);
  if (!data || data->decomposition.rank() < structure().regressors())
    return Eigen::VectorXd::Constant(structure().parameters(), not_a_number);
  return fit_theta(data->transitions, data->decomposition, estimator_, data->scale, nullptr);
}

}  // namespace modebank
