#include "filter/learn/refine/refine.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "filter/learn/refine/cross_validation.hpp"
#include "filter/learn/refine/look_ahead_fit.hpp"
#include "filter/learn/refine/measurement_noise.hpp"
#include "filter/learn/refine/state_dependent_transition.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {
namespace {

/// The parts that are not refined. R of a start is not kept: the fit treats states as measured exactly, so R is already
/// included in Q. Only the variance of rounding stays.
Bank frame_of(const Bank& start, const RefineOptions& options) {
  Bank frame = start;
  if (options.measurement_noise) frame.R = frame.rounding_variance().asDiagonal();
  return frame;
}

/// Numbers of modes for starts from random stretches: the number in the mixture's bank and, if requested, larger
/// numbers.
std::vector<Index> stretch_modes(const RefineOptions& options, Index of_mixture) {
  std::vector<Index> counts;
  const double kept = refine_tuning.modes_kept;
  for (Index modes = options.most_modes; modes > of_mixture;
       modes = static_cast<Index>(kept * static_cast<double>(modes)))
    counts.push_back(modes);
  if (of_mixture > 1) counts.push_back(of_mixture);  // all starts with one mode end in the same maximum
  return counts;
}

/// The starts: banks of the mixture, and banks from random stretches of the runs.
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

/// Chooses the start and the number of iterations first, then the strength of the prior on Q.
CrossValidation cross_validate(const RefineInput& in, const std::vector<Bank>& banks) {
  CrossValidation validation(in);
  const RefineTuning& tuning = refine_tuning;
  validation.consider(
      all_starts(in, banks, validation.possible() ? tuning.Q_transitions : tuning.Q_transitions_unvalidated));
  // The best start with other weights of one prior.
  const auto vary = [&](double RefineStart::*prior, const auto& transitions) {
    std::vector<RefineStart> starts(transitions.size(), validation.chosen().start);
    for (std::size_t i = 0; i < starts.size(); ++i) starts[i].*prior = transitions[i];
    validation.consider(starts);
  };
  if (validation.possible()) vary(&RefineStart::noise_transitions, tuning.other_Q_transitions);
  if (validation.possible() && in.options.densities_ahead() > 1 && !in.options.one_theta &&
      validation.chosen().start.model.modes() > 1)
    vary(&RefineStart::theta_transitions, tuning.theta_transitions);
  return validation;
}

/// The fit on all training runs with exactly measured states; `chosen`: the choice by left-out runs.
TrainingFit fit_exactly(const RefineInput& in, const Fit& chosen, const SwitchingPrior& prior) {
  TrainingFit fit = fit_training_runs(in, chosen.model, prior, chosen.iterations);
  if (Eigen::MatrixXd& weights = fit.model.logit.weights; weights.size() > 0)
    weights.rowwise() -= weights.colwise().mean().eval();  // does not change probabilities
  return fit;
}

}  // namespace

Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& banks,
                       const RefineOptions& options, const FilterOptions& filter) {
  if (banks.empty()) throw std::invalid_argument("refinement needs at least one bank");
  if (!banks.front().motion_parameters.empty())
    throw std::invalid_argument("a bank of the motion model " + banks.front().model +
                                " cannot be refined; expected linear or varx");
  const Bank frame = frame_of(banks.front(), options);
  const TrainingTransitions transitions = gather_training_transitions(recording, frame.structure, frame.noise_factor);
  const RefineInput in{recording, fits, frame, transitions, options, filter};

  const CrossValidation validation = cross_validate(in, banks);
  Refinement result;
  result.start = banks.front();
  Fit chosen = validation.chosen();
  if (options.state_dependent_transition)
    if (std::optional<Fit> with_logit = choose_state_dependent_transition(in, validation, result.switching))
      chosen = std::move(*with_logit);
  chosen.prior = with_logit_prior(in.prior(chosen.start), transitions, chosen.logit_prior);
  const TrainingFit fit = fit_exactly(in, chosen, chosen.prior);
  result.candidates = validation.table(chosen.row);
  result.objective = fit.objective;
  chosen.bank = bank_of_fit(in, fit);
  chosen = fit_with_measurement_noise(in, validation, chosen, result.measurement);
  chosen.bank = with_errors(in, fit, chosen.prior, chosen.R_estimated, chosen.bank);
  if (std::optional<Fit> ahead = fit_looking_ahead(in, validation, chosen, result.look_ahead))
    chosen = std::move(*ahead);
  result.bank = std::move(chosen.bank);
  result.of_splits = std::move(chosen.of_splits);
  return result;
}

}  // namespace modebank
