#include "filter/learn/refine/training_fit.hpp"

#include <limits>
#include <optional>
#include <utility>

#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/switching/mode_screening.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {

SwitchingEmOptions em_options(const RefineOptions& options) {
  return {options.one_theta, options.tolerance, refine_tuning.alternations};
}

SwitchingPrior RefineInput::prior(double noise_transitions) const {
  return switching_prior(transitions, fits.global, fits.prior_sd, noise_transitions, refine_tuning);
}

SwitchingPrior RefineInput::prior(const RefineStart& start) const {
  return towards_one_motion(prior(start.noise_transitions), transitions, start.model, start.theta_transitions,
                            refine_tuning);
}

TrainingFit fit_training_runs(const RefineInput& in, const SwitchingRegression& model, const SwitchingPrior& prior,
                              Index iterations) {
  ExpectationMaximisation em(in.transitions, prior, em_options(in.options), model);
  for (Index i = 0; i < iterations && !em.converged(); ++i) em.step();
  TrainingFit fit{em.model(), em.posterior(), in.frame.screened, em.objective()};
  while (in.options.screen) {
    std::optional<ScreenedModel> rest =
        without_worst_mode(in.transitions, fit.posterior, fit.model, in.options.one_theta, refine_tuning);
    if (!rest) break;
    fit.screened.push_back(std::move(rest->mode));
    ExpectationMaximisation others(in.transitions, prior, em_options(in.options), std::move(rest->model));
    for (Index i = 0; i < refine_tuning.iterations_after_screening; ++i) others.step();
    fit.model = others.model();
    fit.posterior = others.posterior();
  }
  return fit;
}

Bank bank_of_fit(const RefineInput& in, const TrainingFit& fit) {
  Bank bank = with_modes(in.frame, fit.model);
  bank.screened = fit.screened;
  const Eigen::VectorXd transitions =
      (fit.posterior.probability.transpose() * in.transitions.usable).cwiseMax(std::numeric_limits<double>::min());
  for (Index j = 0; j < transitions.size(); ++j)
    bank.modes[static_cast<std::size_t>(j)].weight = transitions(j) / transitions.sum();
  return bank;
}

Bank with_errors(const RefineInput& in, const TrainingFit& fit, const SwitchingPrior& prior, bool estimated_R,
                 const Bank& bank) {
  const SwitchingSums complete = sum_transitions(in.transitions, fit.posterior, prior);
  const FreeParameters free = all_parameters(bank, complete, prior, in.options.one_theta, estimated_R,
                                             least_measurement_noise(in.fits, refine_tuning));
  return with_standard_errors({in.recording, learning_filter, prior, in.options.one_theta}, free, complete, bank);
}

Eigen::VectorXd least_measurement_noise(const WindowFits& fits, const RefineTuning& tuning) {
  return tuning.least_R_share * fits.global.noise_variance();
}

}  // namespace modebank
