#include "filter/learn/refine/refine.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/drift.hpp"
#include "filter/learn/refine/guards.hpp"
#include "filter/learn/refine/look_ahead_fit.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {
namespace {

/// What is not refined. The fit takes the state as measured exactly: a start's R would count what Q then holds twice.
Bank frame_of(const Bank& start, const RefineOptions& options) {
  Bank frame = start;
  if (options.measurement_noise) frame.R.setZero();
  return frame;
}

/// How many modes the stretches start with: more than the mixture's bank has, if so many are to be tried, and as many.
std::vector<Index> stretch_modes(const RefineOptions& options, Index of_mixture) {
  std::vector<Index> counts;
  const double kept = refine_tuning.modes_kept;
  for (Index modes = options.most_modes; modes > of_mixture;
       modes = static_cast<Index>(kept * static_cast<double>(modes)))
    counts.push_back(modes);
  if (of_mixture > 1) counts.push_back(of_mixture);  // every start of one mode ends in the same maximum
  return counts;
}

/// The mixture's banks and random stretches of the runs.
std::vector<RefineStart> all_starts(const RefineInput& in, const std::vector<Bank>& banks, double Q_transitions) {
  std::vector<RefineStart> starts;
  for (const Bank& bank : banks) starts.push_back({"mixture", switching_model(bank), Q_transitions});
  const SwitchingPrior prior = in.prior(Q_transitions);
  for (const Index modes : stretch_modes(in.options, banks.front().mode_count()))
    for (Index i = 0; i < in.options.restarts; ++i)
      starts.push_back(
          {fmt::format("stretches {}", i + 1),
           start_from_stretches(in.transitions, prior, modes, in.fits.length, in.options.seed, i, refine_tuning),
           Q_transitions});
  return starts;
}

/// The best start again, with weaker and stronger priors on Q.
std::vector<RefineStart> other_priors(const RefineStart& best, const RefineTuning& tuning) {
  std::vector<RefineStart> starts;
  for (const double transitions : tuning.other_Q_transitions) {
    starts.push_back(best);
    starts.back().noise_transitions = transitions;
  }
  return starts;
}

/// The best start again, drawn towards one motion more and more.
std::vector<RefineStart> towards_one_motion(const RefineStart& best, const RefineTuning& tuning) {
  std::vector<RefineStart> starts;
  for (const double transitions : tuning.theta_transitions) {
    starts.push_back(best);
    starts.back().theta_transitions = transitions;
  }
  return starts;
}

/// Which start and how many iterations first; then how strong the prior on Q is.
CrossValidation cross_validate(const RefineInput& in, const std::vector<Bank>& banks) {
  CrossValidation validation(in);
  const RefineTuning& tuning = refine_tuning;
  validation.consider(
      all_starts(in, banks, validation.possible() ? tuning.Q_transitions : tuning.Q_transitions_unvalidated));
  if (validation.possible()) validation.consider(other_priors(validation.chosen().start, tuning));
  if (validation.possible() && in.options.densities_ahead() > 1 && !in.options.one_theta &&
      validation.chosen().start.model.modes() > 1)
    validation.consider(towards_one_motion(validation.chosen().start, tuning));
  return validation;
}

/// The chosen fit with modes that drift; standard errors are those of the likelihood that it maximises, without.
Refinement drifting_refinement(const RefineInput& in, const CrossValidation& validation, const DriftChoice& drift,
                               const SwitchingPrior& prior, const TrainingFit& fit, const Bank& start,
                               const SwitchingStage& switching, const DriftStage& stage) {
  const Bank steady =
      with_errors(in, fit, prior, false, exact_filter(in.filter), bank_of_fit(in, fit, drift.adaptation));
  Refinement result{with_drift(steady, drift), start, validation.table(), fit.objective, {}};
  result.switching = switching;
  result.drift = stage;
  for (std::size_t row = 0; row < result.candidates.size(); ++row)
    result.candidates[row].selected = row == drift.fit.row;
  for (const Bank& bank : drift.fit.banks) result.of_splits.push_back(with_drift(bank, drift));
  return result;
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("no bank to refine");
  if (!banks.front().motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + banks.front().model +
                                " cannot be refined, a linear one can");
  const Bank frame = frame_of(banks.front(), options);
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure, frame.noise_factor);
  const RefineInput in{recording, fits, frame, transitions, options, filter};

  const CrossValidation validation = cross_validate(in, banks);
  SwitchingStage switching;
  std::optional<Guards> guards;
  if (options.guards) guards = choose_guards(in, validation, switching);
  const ScoredFit& steady = guards ? guards->fit : validation.chosen();
  DriftStage drift_stage;
  std::optional<DriftChoice> drift;
  if (options.drift != Drift::none) drift = choose_drift(in, validation, steady, !guards, drift_stage);
  const ScoredFit& chosen = validation.of_start(drift ? drift->fit.row : steady.row);
  SwitchingPrior prior = in.prior(chosen.start);
  if (guards) prior = with_guard(std::move(prior), transitions, guards->prior);
  const TrainingFit fit =
      guards ? fit_guards(in, *guards, prior) : fit_training_runs(in, chosen.start, prior, chosen.iterations);
  if (drift) return drifting_refinement(in, validation, *drift, prior, fit, banks.front(), switching, drift_stage);
  const ChosenFit on_splits{guards ? guards->fit.banks : chosen.banks, chosen.start.noise_transitions,
                            guards ? guards->prior : GuardPrior{}, chosen.start.theta_transitions};
  const Bank exact = bank_of_fit(in, fit, validation.adaptation(on_splits.of_splits));
  const MeasuredBank measured = fit_with_measurement_noise(in, validation, on_splits, prior, exact);

  const FilterOptions maximised = measured.stage.iterations > 0 ? learning_filter(filter) : exact_filter(filter);
  Refinement result{with_errors(in, fit, measured.prior, measured.R_estimated, maximised, measured.bank), banks.front(),
                    validation.table(), fit.objective, measured.stage};
  result.switching = switching;
  result.drift = drift_stage;
  result.of_splits = measured.of_splits;
  if (std::optional<Bank> ahead = fit_looking_ahead(in, validation, on_splits, measured.prior, measured.R_estimated,
                                                    result.bank, result.look_ahead, result.of_splits))
    result.bank = std::move(*ahead);
  return result;
}

}  // namespace modebank
