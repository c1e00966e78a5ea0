#include "filter/learn/refine/look_ahead_fit.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

constexpr Index most_iterations = 40;
// A gradient needs a difference for every coordinate. With 200 coordinates (twelve modes on ICE) one fit would take ten
// minutes, and each fold needs a fit.
constexpr Index most_coordinates = 50;
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The coordinates of the search, with units from the sums of expectation-maximisation.
FreeParameters free_parameters(const RefineInput& in, const Recording& recording, const SwitchingPrior& prior,
                               bool R_estimated, const Bank& bank) {
  const TrainingTransitions transitions = gather_training_transitions(recording, bank.structure, bank.noise_factor);
  const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), prior);
  return all_parameters(bank, sums, prior, in.options.one_theta, R_estimated,
                        least_measurement_noise(in.fits, refine_tuning));
}

/// The data and options of a look-ahead fit.
struct LookAheadFit {
  const RefineInput& in;
  LookAhead look;
  bool R_estimated = false;

  Bank climbed(const Recording& recording, const SwitchingPrior& prior, const LookAhead& counted,
               const FreeParameters& free, const Bank& bank) const {
    return maximise_likelihood({recording, learning_filter, prior, in.options.one_theta, counted}, free, bank,
                               {std::min(most_iterations, in.options.max_iterations), in.options.tolerance})
        .bank;
  }

  /// `densities` fits all parameters. `errors` fits theta only; noise and transitions then maximise the likelihood with
  /// this theta.
  Bank continued(const Recording& recording, const SwitchingPrior& prior, const Bank& bank) const {
    const FreeParameters all = free_parameters(in, recording, prior, R_estimated, bank);
    if (!look.counts_errors()) return climbed(recording, prior, look, all, bank);
    FreeParameters rest = all;
    rest.theta_unit.resize(0, 0);
    return climbed(
        recording, prior, {}, rest,
        climbed(recording, prior, look, {.theta_unit = all.theta_unit, .Q = false, .transition = false}, bank));
  }
};

/// Root mean square of the scored errors of the present bank. In this unit, all signals have equal weight and gains are
/// roughly in nats.
Eigen::VectorXd error_unit(const RefineInput& in, const Bank& bank) {
  const Index outputs = bank.C.rows();
  Eigen::VectorXd unit(outputs);
  for (Index i = 0; i < outputs; ++i) {
    LookAhead of_one{in.options.look_ahead, Eigen::VectorXd::Constant(outputs, infinite)};
    of_one.error_unit(i) = 1.0;
    const double half_squares = -training_log_likelihood(bank, in.recording, learning_filter, of_one);
    unit(i) = std::sqrt(2.0 * half_squares / static_cast<double>(in.recording.transitions(Role::train)));
  }
  return unit;
}

/// Empty if there are no samples to score.
std::optional<LookAhead> look_of(const RefineInput& in, const Bank& bank) {
  if (in.options.look_ahead_score == LookAheadScore::density)
    return in.options.look_ahead > 1 ? std::optional<LookAhead>{{in.options.look_ahead}} : std::nullopt;
  const LookAhead look{in.options.look_ahead, error_unit(in, bank)};
  return look.error_unit.allFinite() && (look.error_unit.array() > 0.0).all() ? std::optional(look) : std::nullopt;
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

/// Whether the gain on the left-out runs suffices (left_out/rule.hpp). Each run is scored by a fit without this run.
bool gains(const LookAheadFit& search, const CrossValidation& validation, LookAheadStage& stage, Fit& fit) {
  std::vector<Bank> banks = fit.of_splits;
  const LeftOutScores before = validation.scores(banks, search.look);
  tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
    const SplitData& split = validation.splits()[s];
    SwitchingPrior of_split = prior_of_split(
        search.in, split, {"", switching_model(banks[s]), fit.start.noise_transitions, fit.start.theta_transitions});
    of_split = with_logit_prior(std::move(of_split), split.transitions, fit.logit_prior);
    banks[s] = search.continued(split.runs.training, of_split, banks[s]);
  });
  const LeftOutScores after = validation.scores(banks, search.look);
  stage.score_before = validation.mean_score(before);
  stage.score = validation.mean_score(after);
  const PairedLoss gain = paired_loss(after.log_likelihood, before.log_likelihood, validation.samples());
  stage.gain_standard_error = gain.standard_error;
  if (!is_worth_it(gain, validation.samples())) return false;
  fit.of_splits = std::move(banks);
  return true;
}

}  // namespace

std::optional<Fit> fit_looking_ahead(const RefineInput& in, const CrossValidation& validation, const Fit& fit,
                                     LookAheadStage& stage) {
  if (!validation.possible() && in.options.folds > 1) return std::nullopt;
  const std::optional<LookAhead> look = look_of(in, fit.bank);
  if (!look ||
      BankCoordinates(fit.bank, free_parameters(in, in.recording, fit.prior, fit.R_estimated, fit.bank)).size() >
          most_coordinates)
    return std::nullopt;
  const LookAheadFit search{in, *look, fit.R_estimated};
  Fit ahead = fit;
  stage.of_errors = look->counts_errors();
  stage.taken = !validation.possible() || gains(search, validation, stage, ahead);
  if (!stage.taken) return std::nullopt;
  ahead.bank = without_errors(search.continued(in.recording, fit.prior, fit.bank));
  return ahead;
}

}  // namespace modebank
