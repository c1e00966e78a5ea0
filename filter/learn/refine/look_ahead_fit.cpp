#include "filter/learn/refine/look_ahead_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr Index most_iterations = 40;
// Each is differenced at every gradient: with 200 (twelve modes on ice) a fit would take ten minutes, and there are as
// many as folds.
constexpr Index most_coordinates = 50;

/// What is searched, with units from the sums of expectation-maximisation.
FreeParameters free_parameters(const RefineInput& in, const Recording& recording, const SwitchingPrior& prior,
                               bool R_estimated, const Bank& bank) {
  const TrainingTransitions transitions = gather_training_transitions(recording, bank.structure);
  const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), prior);
  return all_parameters(bank, sums, prior, in.options.one_theta, R_estimated,
                        least_measurement_noise(in.fits, in.options.tuning));
}

Bank taken_on(const LikelihoodTarget& target, const RefineInput& in, bool R_estimated, const Bank& bank) {
  return maximise_likelihood(target, free_parameters(in, target.recording, *target.prior, R_estimated, bank), bank,
                             {std::min(most_iterations, in.options.max_iterations), in.options.tolerance})
      .bank;
}

Bank without_errors(Bank bank) {
  for (Mode& mode : bank.modes) {
    mode.standard_error.setConstant(not_a_number);
    mode.Q_standard_error.resize(0, 0);
  }
  bank.R_standard_error.resize(0, 0);
  bank.transition_standard_error.resize(0, 0);
  bank.transition_weight_error.resize(0, 0);
  return bank;
}

}  // namespace

std::optional<Bank> fit_looking_ahead(const RefineInput& in, const CrossValidation& validation, const ChosenFit& chosen,
                                      const SwitchingPrior& prior, bool R_estimated, const Bank& bank,
                                      LookAheadStage& stage) {
  if (in.options.look_ahead == 1 || !validation.possible()) return std::nullopt;
  if (BankCoordinates(bank, free_parameters(in, in.recording, prior, R_estimated, bank)).size() > most_coordinates)
    return std::nullopt;
  const FilterOptions filter = learning_filter(in.filter);
  std::vector<Bank> banks = chosen.of_splits;
  for (Bank& of_split : banks) of_split.noise_adaptation = bank.noise_adaptation;
  stage.score_before = validation.score(banks);
  tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
    const SplitData& split = validation.splits()[s];
    SwitchingPrior of_split =
        prior_of_split(in, split, {"", switching_model(banks[s]), chosen.noise_transitions, chosen.theta_transitions});
    of_split = with_guard(std::move(of_split), split.transitions, chosen.guard);
    banks[s] = taken_on({split.runs.training, filter, of_split, in.options.one_theta, in.options.look_ahead}, in,
                        R_estimated, banks[s]);
  });
  stage.score = validation.score(banks);
  if (!(stage.score > stage.score_before + in.options.tuning.least_gain)) return std::nullopt;
  stage.taken = true;
  return without_errors(
      taken_on({in.recording, filter, prior, in.options.one_theta, in.options.look_ahead}, in, R_estimated, bank));
}

}  // namespace modebank
