#include "filter/refine_fit.hpp"

#include "filter/refine_climb.hpp"
#include "filter/refine_screening.hpp"

namespace modebank {
namespace {

constexpr Index iterations_after_screening = 10;

}  // namespace

TrainingFit fit_training_runs(const Bank& frame, const RefineStart& start, const TrainingTransitions& transitions,
                              const SwitchingPrior& prior, const RefineOptions& options, Index iterations) {
  Climb climb(transitions, prior, start.shared, options.tolerance, start.model);
  for (Index i = 0; i < iterations && !climb.converged(); ++i) climb.step();
  TrainingFit fit{climb.model(), climb.posterior(), frame.screened, climb.objective()};
  while (options.screen &&
         screen_worst_mode(frame.structure, transitions, fit.posterior, start.shared, fit.model, fit.screened)) {
    Climb rest(transitions, prior, start.shared, options.tolerance, fit.model);
    for (Index i = 0; i < iterations_after_screening; ++i) rest.step();
    fit.model = rest.model();
    fit.posterior = rest.posterior();
  }
  return fit;
}

}  // namespace modebank
