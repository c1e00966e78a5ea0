#include "filter/refine.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

#include "filter/refine_average.hpp"
#include "filter/refine_errors.hpp"
#include "filter/refine_fit.hpp"
#include "filter/refine_noise.hpp"
#include "filter/refine_start.hpp"
#include "filter/refine_validation.hpp"
#include "filter/refined_modes.hpp"
#include "filter/switching_state_space.hpp"
#include "filter/training_likelihood.hpp"

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
    for (const SharedParts shared : ways_to_share(options.share))
      starts.push_back({name, model, shared, first_strength(options)});
  return starts;
}

/// What the search for R, and what follows it, works with.
struct MeasuredFit {
  const Recording& recording;
  const RefineOptions& options;
  const FilterOptions& filter;
  const SwitchingPrior& prior;
  SharedParts shared;
  Eigen::VectorXd least_R;

  void step(Bank& bank) const {
    step_state_space(recording, prior, shared, filter.time_steps, least_R, options.measurement_noise, bank);
  }
  double objective(const Bank& bank) const {
    FilterOptions gaussian;
    gaussian.time_steps = filter.time_steps;
    return training_log_likelihood(bank, recording, gaussian) + log_prior(prior, shared, switching_model(bank));
  }

  /// As long as the objective rises; the best iterate is kept.
  Index run_to_convergence(Bank& bank) const {
    const double least_rise = options.tolerance * static_cast<double>(recording.transitions(Role::train));
    double best = objective(bank);
    Index done = 0;
    for (Bank next = bank; done < options.max_iterations; ++done) {
      step(next);
      const double value = objective(next);
      if (!(value > best)) break;
      const bool stands_still = value - best < least_rise;
      best = value;
      bank = next;
      if (stands_still) return done + 1;
    }
    return done;
  }
};

/// Goes on with the states unknown where R is more than nothing.
MeasurementStage fit_with_measurement_noise(const MeasuredFit& fit, const CrossValidation& validation, Bank& bank) {
  const double Q_before = bank.modes.front().Q(0, 0);
  if (fit.options.measurement_noise) {
    estimate_measurement_noise(fit.recording, fit.filter, bank);
    if (bank.R_standard_error.size() == 0) return {};
  } else if (!(bank.R.diagonal().array() > fit.least_R.array()).any()) {
    return {};
  }
  if (!validation.possible()) return {fit.run_to_convergence(bank)};
  const MeasurementStage stage =
      validation.with_measurement_noise(bank.R, bank.modes.front().Q(0, 0) / Q_before, bank.noise_adaptation);
  for (Index i = 0; i < stage.iterations; ++i) fit.step(bank);
  return stage;
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
  const MeasuredFit fit{recording, options, filter, prior, start.shared, least_measurement_noise(fits)};
  result.measurement = fit_with_measurement_noise(fit, validation, result.bank);
  const SwitchingSums sums = result.measurement.iterations > 0
                                 ? smooth_states(result.bank, recording, prior, filter.time_steps).switching
                                 : sum_transitions(transitions, posterior, prior);
  const bool with_R = result.bank.R_standard_error.size() > 0;
  set_standard_errors(recording, sums, prior, start.shared, with_R, result.bank);
  if (options.members > 1 && !with_R && result.measurement.iterations == 0)
    average_fits({recording, fits, frame, transitions, options}, validation, result);
  return result;
}

}  // namespace modebank
