#include "filter/learn/refine/measurement_noise.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/work_counter.hpp"

namespace modebank {
namespace {

/// With more states than this, a filter pass is slow. Then R is searched from one start. theta is searched, too, only
/// if there are few coordinates.
constexpr Index most_states_of_wide_search = 4, most_coordinates_of_large_filters = 40;
constexpr Index first_iterations = 30;  // the ascent over everything starts where the search for R ends

/// The bank with `share` of the mean Q in R, subtracted from Q. Measurement noise of variance r raises the residual
/// variance of exact states by about 2 r. R begins at the variance of rounding.
Bank with_share_as_R(Bank bank, double share) {
  const Index n_y = bank.R.rows();
  Eigen::VectorXd mean_Q = Eigen::VectorXd::Zero(n_y);
  for (const Mode& mode : bank.modes) mean_Q += mode.weight * mode.Q.diagonal().head(n_y);
  bank.R = (bank.rounding_variance() + share * mean_Q).asDiagonal();
  for (Mode& mode : bank.modes) mode.Q *= 1.0 - 2.0 * share;
  return bank;
}

/// The prior for unknown states. It equals the prior of the fit with exactly measured states, except for Q. Q has one
/// additional transition, with the harmonic mean covariance of the modes in `start`. (The global residual covariance
/// would include the differences between modes and outweigh the data of very different modes.) A harmonic mean is at
/// most a few times the smallest Q. So the prior hardly raises Q of any mode.
SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start) {
  SwitchingPrior prior = exact;
  prior.noise_transitions = refine_tuning.Q_transitions_with_R;
  const Index n = start.structure.states;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Mode& mode : start.modes) {
    const std::optional<Eigen::MatrixXd> inverse = definite_inverse(mode.Q.topLeftCorner(n, n));
    if (!inverse) return prior;
    information += *inverse;
  }
  if (const std::optional<Eigen::MatrixXd> inverse = definite_inverse(information))
    prior.noise = static_cast<double>(start.mode_count()) * *inverse;
  return prior;
}

/// theta, Q, T and (`with_R`) R of a bank.
FreeParameters everything(const RefineInput& in, const TrainingTransitions& transitions, const LikelihoodTarget& target,
                          const Bank& bank, bool with_R) {
  const SwitchingSums sums =
      sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), *target.prior);
  return all_parameters(bank, sums, *target.prior, in.options.one_theta, with_R, in.least_R());
}

LikelihoodTarget target_of(const RefineInput& in, const Recording& recording, const SwitchingPrior& exact,
                           const Bank& bank) {
  return {recording, learning_filter, prior_with_states_unknown(exact, bank), in.options.one_theta};
}

/// Maximises the likelihood over theta, Q, T and (`with_R`) R of a bank together. An R that the likelihood does not see
/// is the least one: rounding would decide its digits.
MeasurementNoise maximise_everything(const RefineInput& in, const Recording& recording,
                                     const TrainingTransitions& transitions, const SwitchingPrior& exact,
                                     const Bank& bank, bool with_R) {
  const LikelihoodTarget target = target_of(in, recording, exact, bank);
  LikelihoodMaximum maximum = maximise_likelihood(target, everything(in, transitions, target, bank, with_R), bank,
                                                  {in.options.max_iterations, in.options.tolerance});
  Bank least = maximum.bank;
  if (with_R) least.R = least.R.cwiseMin(Eigen::MatrixXd(in.least_R().asDiagonal()));
  const double unseen = in.options.tolerance * static_cast<double>(recording.transitions(Role::train));
  if (with_R && target.value(least) > maximum.value - unseen) maximum.bank = std::move(least);
  return {std::move(maximum.bank), *target.prior, 0, maximum.iterations, maximum.end};
}

/// The highest end of the ascents from these starts, if it is above end_at.least_value. Counts the starts that failed.
std::optional<LikelihoodMaximum> highest_end(const LikelihoodTarget& target, const FreeParameters& free,
                                             const std::vector<Bank>& starts, const AscentLimits& end_at,
                                             Index& failed) {
  std::vector<LikelihoodMaximum> ends(starts.size());
  WorkCounter counter("searches for measurement noise", ends.size());
  tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t i) {
    ends[i] = maximise_likelihood(target, free, starts[i], end_at);
    counter.add();
  });
  failed = std::count_if(ends.begin(), ends.end(), [](const LikelihoodMaximum& end) {
    return !std::isfinite(end.value) || (end.end == MeasuredFit::stalled && !end.rose);
  });
  std::optional<LikelihoodMaximum> best;
  double least = end_at.least_value;
  for (LikelihoodMaximum& end : ends) {
    if (!std::isfinite(end.value) || end.value <= least) continue;
    // Results that differ by less than the search tolerance count as equal.
    least = end.value + end_at.tolerance * static_cast<double>(target.recording.transitions(Role::train));
    best = std::move(end);
  }
  return best;
}

/// Replaces the fit, and its splits, by what `change` makes of them, if the left-out runs do not lose by it.
template <class Change>
void take(const RefineInput& in, const CrossValidation& validation, const SwitchingPrior& exact, bool with_R,
          Change change, Fit& fit, MeasurementStage& stage) {
  MeasurementNoise changed = change(in.recording, in.transitions, exact, fit.bank);
  if (with_R) {
    stage.starts += std::ssize(R_start_shares);
    stage.failed_starts += changed.failed_starts;
  }
  if (!changed.bank) return;
  if (validation.possible()) {
    std::vector<Bank> banks = fit.of_splits;
    tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
      const SplitData& split = validation.splits()[s];
      MeasurementNoise of_split = change(split.runs.training, split.transitions, split.prior(in, fit.start), banks[s]);
      if (of_split.bank) banks[s] = *std::move(of_split.bank);
    });
    const double before = validation.mean_score(validation.scores(fit.of_splits)),
                 after = validation.mean_score(validation.scores(banks));
    if (std::isnan(stage.score)) stage.score_before = stage.score = before;
    // The scores of splits that have no such R do not test it. On ICE no split had it, and one_motion lost 0.19 nats.
    if (!std::isfinite(after) || after < before - refine_tuning.least_gain ||
        (with_R && !mostly_have(banks, changed.bank->R)))
      return;
    stage.score = after;
    fit.of_splits = std::move(banks);
  }
  fit.prior = std::move(changed.prior);
  fit.bank = *std::move(changed.bank);
  fit.R_estimated = with_R;
  stage.iterations += changed.iterations;
  stage.end = changed.end;
}

}  // namespace

MeasurementNoise find_measurement_noise(const RefineInput& in, const Recording& recording,
                                        const TrainingTransitions& transitions, const SwitchingPrior& exact,
                                        const Bank& bank, const std::array<double, 2>& shares) {
  const LikelihoodTarget target = target_of(in, recording, exact, bank);
  const double samples = static_cast<double>(recording.transitions(Role::train));
  const AscentLimits end_at{first_iterations, in.options.tolerance,
                            target.value(bank) + refine_tuning.least_gain * samples};
  FreeParameters with_theta = everything(in, transitions, target, bank, true);
  with_theta.Q_by_one_factor = true;  // separate Q gain by themselves, because expectation-maximisation stops early
  with_theta.transition = false;
  FreeParameters noise = with_theta;
  noise.theta_unit.resize(0, 0);
  std::vector<Bank> starts;
  for (const double share : shares) starts.push_back(with_share_as_R(bank, share));
  const bool is_large = bank.structure.dimension() > most_states_of_wide_search;
  if (is_large)
    starts = {*std::max_element(starts.begin(), starts.end(), [&](const Bank& a, const Bank& b) {
      return is_below(target.value(a), target.value(b));
    })};

  MeasurementNoise result;
  Index not_counted = 0;  // of the same starts
  std::optional<LikelihoodMaximum> best = highest_end(target, noise, starts, end_at, result.failed_starts);
  if (!best && (!is_large || BankCoordinates(bank, with_theta).size() <= most_coordinates_of_large_filters))
    best = highest_end(target, with_theta, {starts.front()}, end_at, not_counted);
  if (!best) return result;
  const Index failed = result.failed_starts;
  // From here on, the prior is that of a Q without R. That of exact states includes R, and would be too large.
  result = maximise_everything(in, recording, transitions, exact, best->bank, true);
  result.failed_starts = failed;
  return result;
}

bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R) {
  const auto has = [&](const Bank& bank) { return 10.0 * bank.R.trace() >= R.trace(); };
  return 2 * std::count_if(banks.begin(), banks.end(), has) >= std::ssize(banks);
}

Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, const Fit& exact,
                               MeasurementStage& stage) {
  const auto begin = std::chrono::steady_clock::now();
  Fit fit = exact;
  // The search for R uses gradients. These ignore that a noise factor changes with the state.
  const bool with_R = in.options.measurement_noise && fit.bank.structure.state_lags <= most_lags_beside_R &&
                      fit.bank.noise_factor.empty();
  const bool quantised = fit.bank.is_quantised();
  // If states count as exact, Q includes the rounding. Only a fit with R separates rounding from Q.
  if (quantised || (!with_R && (fit.bank.R.diagonal().array() > in.least_R().array()).any()))
    take(
        in, validation, exact.prior, false,
        [&](const auto&... of_runs) { return maximise_everything(in, of_runs..., false); }, fit, stage);
  if (with_R)
    take(
        in, validation, exact.prior, true,
        [&](const auto&... of_runs) { return find_measurement_noise(in, of_runs..., R_start_shares); }, fit, stage);
  stage.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace modebank
