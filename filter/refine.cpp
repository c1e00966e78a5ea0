#include "filter/refine.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

#include "filter/refine_average.hpp"
#include "filter/refine_errors.hpp"
#include "filter/refine_fit.hpp"
#include "filter/refine_measured.hpp"
#include "filter/refine_start.hpp"
#include "filter/refine_validation.hpp"
#include "filter/refined_modes.hpp"
#include "filter/switching_state_space.hpp"

namespace modebank {
namespace {

// Transitions that the prior on Q is worth: at first, and where nothing is left out to choose by.
constexpr double prior_strength = 4.0, unit_strength = 1.0;
constexpr std::array<double, 2> other_strengths{1.0, 16.0};

double first_strength(const RefineOptions& options) { return options.folds > 1 ? prior_strength : unit_strength; }

std::vector<SharedParts> ways_to_share(Sharing share) {
  switch (share) {
    case Sharing::none:
      return {SharedParts::none};
    case Sharing::theta:
      return {SharedParts::theta};
    case Sharing::noise:
      return {SharedParts::noise};
    case Sharing::best:
      break;
  }
  return {SharedParts::none, SharedParts::theta, SharedParts::noise};
}

/// Which start, what its modes share and how many iterations first; then how strong the prior on Q is.
CrossValidation cross_validate(const Recording& recording, const WindowFits& fits,
                               const std::vector<RefineStart>& candidates, const Bank& frame,
                               const RefineOptions& options, const FilterOptions& filter) {
  CrossValidation validation(recording, fits, frame, options, filter);
  validation.consider(candidates);
  if (!validation.possible()) return validation;
  std::vector<RefineStart> by_strength;
  for (const double strength : other_strengths) {
    by_strength.push_back(validation.best());
    by_strength.back().noise_transitions = strength;
  }
  validation.consider(by_strength);
  return validation;
}

std::vector<RefineStart> all_starts(const WindowFits& fits, const std::vector<Bank>& banks,
                                    const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                    const RefineOptions& options) {
  std::vector<std::pair<std::string, SwitchingRegression>> models;
  for (const Bank& bank : banks) models.emplace_back("mixture", switching_model(bank));
  for (Index i = 0; i < options.restarts; ++i)
    models.emplace_back(
        fmt::format("stretches {}", i + 1),
        start_from_stretches(transitions, prior, banks.front().mode_count(), fits.length, options.seed, i));
  std::vector<RefineStart> starts;
  for (const auto& [name, model] : models)
    for (const SharedParts shared : ways_to_share(options.share)) {
      starts.push_back({name, model, shared, first_strength(options)});
      if (model.modes() == 1) break;  // it shares nothing
    }
  return starts;
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("no bank to refine");
  Bank frame = banks.front();
  // The fit takes the state as measured exactly: a start's R would count what Q then holds twice.
  if (options.measurement_noise) frame.R = least_measurement_noise(fits).asDiagonal().toDenseMatrix();
  if (!frame.motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + frame.model + " cannot be refined, a linear one can");
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure);
  SwitchingPrior prior = switching_prior(transitions, fits.global, fits.prior_sd, first_strength(options));
  const CrossValidation validation =
      cross_validate(recording, fits, all_starts(fits, banks, transitions, prior, options), frame, options, filter);

  Refinement result;
  result.start = banks.front();
  result.candidates = validation.table();
  const RefineStart& start = validation.best();
  prior.noise_transitions = start.noise_transitions;
  auto [model, posterior, screened, objective] =
      fit_training_runs(frame, start, transitions, prior, options, validation.iterations());
  result.objective = std::move(objective);
  result.bank = with_modes(frame, model);
  result.bank.screened = std::move(screened);
  result.bank.noise_adaptation = validation.adaptation();
  set_weights(posterior.probability.transpose() * transitions.usable, result.bank);
  LikelihoodTarget target{recording,    learning_filter(filter),       prior,
                          start.shared, least_measurement_noise(fits), options.measurement_noise};
  result.measurement = fit_with_measurement_noise(options, filter, validation, target, result.bank);
  const SwitchingSums sums = result.measurement.iterations > 0
                                 ? smooth_states(result.bank, recording, target.prior, filter.time_steps).switching
                                 : sum_transitions(transitions, posterior, prior);
  const bool with_R = result.bank.R_standard_error.size() > 0;
  set_standard_errors(recording, sums, target.prior, start.shared, with_R, result.bank);
  if (options.members > 1 && !with_R && result.measurement.iterations == 0)
    average_fits({recording, fits, frame, transitions, options}, validation, result);
  return result;
}

}  // namespace modebank
