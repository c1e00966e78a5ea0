#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// With more states, a filter pass is slow. Then R is searched from the likelier start only, over theta only with few
/// coordinates.
constexpr Index most_states_of_wide_search = 4, most_coordinates_of_large_filters = 40;
/// Starting values of R, as shares of the mean Q; below a half, because R enters Q twice. The first also starts theta.
constexpr std::array R_start_shares{0.05, 0.45};
constexpr Index first_iterations = 30;  // the ascent over everything starts where the search for R ends

double samples_of(const LearningRuns& runs) { return static_cast<double>(runs.recording.transitions(Role::train)); }

/// The bank with `share` of the mean Q in R. Measurement noise of variance r raises the residual variance of exact
/// states by about 2 r.
Bank with_share_as_R(Bank bank, double share) {
  const Index n_y = bank.R.rows();
  Eigen::VectorXd mean_Q = Eigen::VectorXd::Zero(n_y);
  for (const Mode& mode : bank.modes) mean_Q += mode.weight * mode.Q.diagonal().head(n_y);
  bank.R = (bank.rounding_variance() + share * mean_Q).asDiagonal();
  for (Mode& mode : bank.modes) mode.Q *= 1.0 - 2.0 * share;
  return bank;
}

/// The prior for unknown states. Q has one additional transition, with the harmonic mean covariance of the modes in
/// `start`. (The global residual covariance includes the differences between modes and would outweigh the data.)
SwitchingPrior prior_with_states_unknown(SwitchingPrior prior, const Bank& start) {
  prior.noise_transitions = 1.0;
  const Index n = start.structure.states;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Mode& mode : start.modes)
    if (const auto inverse = definite_inverse(mode.Q.topLeftCorner(n, n)))
      information += *inverse;
    else
      return prior;
  if (const auto inverse = definite_inverse(information))
    prior.noise = static_cast<double>(start.mode_count()) * *inverse;
  return prior;
}

/// Of a search from a bank, over theta, Q, T and (`with_R`) R.
std::pair<LikelihoodTarget, FreeParameters> search_from(const Bank& bank, const RefineInput& in,
                                                        const LearningRuns& runs, const SwitchingPrior& exact,
                                                        bool with_R) {
  const SwitchingPrior prior = prior_with_states_unknown(exact, bank);
  const ModePosterior posterior = smooth_modes(runs.transitions, switching_model(bank));
  const Bank with_units = with_complete_errors(runs.transitions, posterior, prior, bank);
  return {{runs.recording, {}, prior, in.options.one_theta},
          all_parameters(with_units, in.options.one_theta, with_R, in.least_R())};
}

/// Maximises the likelihood over theta, Q, T and (`with_R`) R together. An R that the likelihood does not see is the
/// least one: rounding would decide its digits.
MeasurementNoise maximise_everything(const RefineInput& in, const LearningRuns& runs, const SwitchingPrior& exact,
                                     const Bank& bank, bool with_R) {
  const auto [target, free] = search_from(bank, in, runs, exact, with_R);
  LikelihoodMaximum maximum =
      maximise_likelihood(target, free, bank, {in.options.max_iterations, in.options.tolerance});
  Bank least = maximum.bank;
  if (with_R) least.R = least.R.cwiseMin(Eigen::MatrixXd(in.least_R().asDiagonal()));
  if (with_R && target.value(least) > maximum.value - in.options.tolerance * samples_of(runs))
    maximum.bank = std::move(least);
  return {std::move(maximum.bank), *target.prior, 0, maximum.iterations, maximum.end};
}

/// The highest end of these ascents, if it is above end_at.least_value.
std::optional<LikelihoodMaximum> highest_end(const LikelihoodTarget& target, const FreeParameters& free,
                                             const std::vector<Bank>& starts, const AscentLimits& end_at,
                                             Index& failed) {
  std::vector<LikelihoodMaximum> ends(starts.size());
  tbb::parallel_for(std::size_t{0}, ends.size(),
                    [&](std::size_t i) { ends[i] = maximise_likelihood(target, free, starts[i], end_at); });
  std::optional<LikelihoodMaximum> best;
  double least = end_at.least_value;
  for (LikelihoodMaximum& end : ends) {
    if (!std::isfinite(end.value) || (end.end == MeasuredFit::stalled && !end.rose)) ++failed;
    if (!std::isfinite(end.value) || end.value <= least) continue;
    // Results that differ by less than the search tolerance count as equal.
    least = end.value + end_at.tolerance * static_cast<double>(target.recording.transitions(Role::train));
    best = std::move(end);
  }
  return best;
}

/// Replaces the fit, and its splits, by those with unknown states, if the left-out runs do not lose by it.
void take(const RefineInput& in, const CrossValidation& validation, const SwitchingPrior& exact, bool with_R, Fit& fit,
          MeasurementStage& stage) {
  const auto change = [&](const LearningRuns& runs, const SwitchingPrior& prior, const Bank& bank) {
    return with_R ? find_measurement_noise(in, runs, prior, bank) : maximise_everything(in, runs, prior, bank, false);
  };
  MeasurementNoise changed = change(in.all, exact, fit.bank);
  if (with_R) stage.starts += std::ssize(R_start_shares);
  stage.failed_starts += changed.failed_starts;
  if (!changed.bank) return;
  if (validation.possible()) {
    std::vector<Bank> banks = fit.of_splits;
    tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
      const LearningRuns& runs = validation.learning()[s];
      banks[s] = change(runs, in.prior(fit.candidate, runs), banks[s]).bank.value_or(banks[s]);
    });
    const double before = validation.mean_score(validation.scores(fit.of_splits));
    const double after = validation.mean_score(validation.scores(banks));
    if (std::isnan(stage.score)) stage.score_before = stage.score = before;
    // The scores of splits that have no such R do not test it. On ICE no split had it, and one_motion lost 0.19 nats.
    if (!std::isfinite(after) || after < before - least_gain || (with_R && !mostly_have(banks, changed.bank->R)))
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

MeasurementNoise find_measurement_noise(const RefineInput& in, const LearningRuns& runs, const SwitchingPrior& exact,
                                        const Bank& bank) {
  auto [target, with_theta] = search_from(bank, in, runs, exact, true);
  const AscentLimits end_at{first_iterations, in.options.tolerance, target.value(bank) + least_gain * samples_of(runs)};
  with_theta.Q_by_one_factor = true;  // separate Q gain by themselves, because expectation-maximisation stops early
  with_theta.transition = false;
  FreeParameters noise = with_theta;
  noise.theta_unit.resize(0, 0);
  std::vector<Bank> starts;
  for (const double share : R_start_shares) starts.push_back(with_share_as_R(bank, share));
  const bool is_large = bank.structure.dimension() > most_states_of_wide_search;
  if (is_large) starts = {is_below(target.value(starts[0]), target.value(starts[1])) ? starts[1] : starts[0]};

  Index failed = 0, not_counted = 0;  // of the same starts
  std::optional<LikelihoodMaximum> best = highest_end(target, noise, starts, end_at, failed);
  if (!best && (!is_large || BankCoordinates(bank, with_theta).size() <= most_coordinates_of_large_filters))
    best = highest_end(target, with_theta, {starts.front()}, end_at, not_counted);
  if (!best) return {std::nullopt, {}, failed};
  // From here on, the prior is that of a Q without R. That of exact states includes R, and would be too large.
  MeasurementNoise result = maximise_everything(in, runs, exact, best->bank, true);
  result.failed_starts = failed;
  return result;
}

bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R) {
  const auto has = [&](const Bank& bank) { return 10.0 * bank.R.trace() >= R.trace(); };
  return 2 * std::count_if(banks.begin(), banks.end(), has) >= std::ssize(banks);
}

Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, Fit fit,
                               MeasurementStage& stage) {
  const auto begin = std::chrono::steady_clock::now();
  const SwitchingPrior exact = fit.prior;
  // The search for R uses gradients. These ignore that a noise factor changes with the state.
  const bool with_R = in.options.measurement_noise && fit.bank.structure.state_lags <= most_lags_beside_R &&
                      fit.bank.noise_factor.empty();
  // If states count as exact, Q includes the rounding. Only a fit with R separates rounding from Q.
  if (fit.bank.is_quantised() || (!with_R && (fit.bank.R.diagonal().array() > in.least_R().array()).any()))
    take(in, validation, exact, false, fit, stage);
  if (with_R) take(in, validation, exact, true, fit, stage);
  stage.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return fit;
}

}  // namespace modebank
