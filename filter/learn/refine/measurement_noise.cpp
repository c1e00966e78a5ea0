#include "filter/learn/refine/measurement_noise.hpp"

#include <tbb/parallel_for.h>

#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "filter/learn/likelihood/standard_errors.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

// The search for R alone: its end is where the fit of everything begins.
constexpr AscentLimits search_limits{30, 1e-7};

/// What measurement noise did to a fit: its R, and one factor on every Q.
Bank with_noise_of(Bank bank, const Eigen::MatrixXd& R, double Q_factor, const NoiseAdaptation& adaptation) {
  for (Mode& mode : bank.modes) mode.Q *= Q_factor;
  bank.R = R;
  bank.noise_adaptation = adaptation;
  return bank;
}

/// Theta, Q, T and (where it is to be estimated) R of a bank together, from there to the maximum on these runs.
LikelihoodMaximum maximise_everything(const LikelihoodTarget& target, const RefineInput& in, const Bank& bank) {
  const TrainingTransitions transitions = gather_training_transitions(target.recording, bank.structure);
  const SwitchingSums sums =
      sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), *target.prior);
  const FreeParameters free =
      all_parameters(bank, sums, *target.prior, in.options.one_theta, in.options.measurement_noise,
                     least_measurement_noise(in.fits, in.options.tuning));
  return maximise_likelihood(target, free, bank, {in.options.max_iterations, in.options.tolerance});
}

/// Mean log scores of the runs left out before and after the fit goes on: from the fits to the others, with the R of
/// all training runs. A fit to all of them would have seen what is left out.
std::pair<double, double> scores_left_out(const LikelihoodTarget& target, const RefineInput& in,
                                          const CrossValidation& validation, const std::vector<Bank>& of_splits,
                                          const MeasuredBank& measured, double Q_factor) {
  std::vector<Bank> banks;
  for (const Bank& of_split : of_splits)
    banks.push_back(with_noise_of(of_split, measured.bank.R, Q_factor, measured.bank.noise_adaptation));
  const double before = validation.score(banks);
  tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
    const LikelihoodTarget of_split{validation.splits()[s].runs.training, target.filter, target.prior,
                                    target.one_theta};
    banks[s] = maximise_everything(of_split, in, banks[s]).bank;
  });
  return {before, validation.score(banks)};
}

}  // namespace

std::optional<Bank> estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                               const RefineTuning& tuning) {
  const Index n_y = bank.R.rows();
  Eigen::VectorXd mean_Q = Eigen::VectorXd::Zero(n_y);
  for (const Mode& mode : bank.modes) mean_Q += mode.weight * mode.Q.diagonal().head(n_y);
  // White measurement noise of variance r enters a residual of exact states about twice.
  const Bank start = with_noise_of(bank, (tuning.R_start_share * mean_Q).asDiagonal(), 1.0 - 2.0 * tuning.R_start_share,
                                   bank.noise_adaptation);
  const double before = target.value(bank);
  if (!(target.value(start) > before)) return std::nullopt;
  FreeParameters free;
  free.Q_by_one_factor = true;
  free.R.resize(static_cast<std::size_t>(n_y));
  std::iota(free.R.begin(), free.R.end(), Index{0});
  free.least_R = Eigen::VectorXd::Zero(n_y);
  free.transition = false;
  LikelihoodMaximum maximum = maximise_likelihood(target, free, start, search_limits);
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  if (!(maximum.value > before + tuning.least_gain * transitions)) return std::nullopt;
  return std::move(maximum.bank);
}

SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start, const RefineTuning& tuning) {
  SwitchingPrior prior = exact;
  prior.noise_transitions = tuning.Q_transitions_with_R;
  const Index n = start.structure.states;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Mode& mode : start.modes) information += definite_inverse(mode.Q.topLeftCorner(n, n));
  const Eigen::MatrixXd mean = static_cast<double>(start.mode_count()) * definite_inverse(information);
  if (mean.allFinite()) prior.noise = mean;
  return prior;
}

MeasuredBank fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation,
                                        const std::vector<Bank>& of_splits, const SwitchingPrior& prior,
                                        const Bank& bank) {
  const RefineTuning& tuning = in.options.tuning;
  MeasuredBank result{bank, {}, prior};
  if (in.options.measurement_noise) {
    std::optional<Bank> with_R = estimate_measurement_noise({in.recording, in.filter, std::nullopt}, bank, tuning);
    if (!with_R) return result;
    result.bank = std::move(*with_R);
    result.R_estimated = true;
  } else if (!(bank.R.diagonal().array() > least_measurement_noise(in.fits, tuning).array()).any()) {
    return result;
  }
  result.prior = prior_with_states_unknown(prior, result.bank, tuning);
  const LikelihoodTarget target{in.recording, learning_filter(in.filter), result.prior, in.options.one_theta};
  LikelihoodMaximum maximum = maximise_everything(target, in, result.bank);
  result.stage = {maximum.iterations, maximum.end};
  if (validation.possible()) {
    const double Q_factor = result.bank.modes.front().Q(0, 0) / bank.modes.front().Q(0, 0);
    std::tie(result.stage.score_before, result.stage.score) =
        scores_left_out(target, in, validation, of_splits, result, Q_factor);
    if (result.stage.score < result.stage.score_before - tuning.least_gain) {
      result.stage = {0, MeasuredFit::none, result.stage.score_before, result.stage.score_before};
      return result;
    }
  }
  result.bank = std::move(maximum.bank);
  return result;
}

}  // namespace modebank
