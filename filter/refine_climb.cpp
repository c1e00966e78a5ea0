#include "filter/refine_climb.hpp"

#include <utility>

namespace modebank {

Climb::Climb(const TrainingTransitions& transitions, const SwitchingPrior& prior, SharedParts shared, double tolerance,
             SwitchingRegression start)
    : transitions_(transitions), prior_(prior), shared_(shared), tolerance_(tolerance), model_(std::move(start)) {
  posterior_ = smooth_modes(transitions_, model_);
}

void Climb::step() {
  if (converged_) return;
  objective_.push_back(posterior_.log_likelihood + log_prior(prior_, shared_, model_));
  maximise(transitions_.structure, sum_transitions(transitions_, posterior_, prior_), prior_, shared_, model_);
  posterior_ = smooth_modes(transitions_, model_);
  const double gain = posterior_.log_likelihood + log_prior(prior_, shared_, model_) - objective_.back();
  // The first step leaves the start's own optimum for the prior's and may lose.
  converged_ = objective_.size() > 1 && gain < tolerance_ * static_cast<double>(transitions_.count());
}

}  // namespace modebank
