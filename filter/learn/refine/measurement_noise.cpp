#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/cross_validation.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

/// The prior for unknown states. Q has one additional transition, with the harmonic mean covariance of the modes in
/// `start`. (The global residual covariance includes the differences between modes and would outweigh the data.)
SwitchingPrior prior_with_states_unknown(SwitchingPrior prior, const Bank& start) {
  prior.noise_transitions = 1.0;
  const Index n = start.structure.states;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Mode& mode : start.modes) {
    const auto inverse = definite_inverse(mode.Q.topLeftCorner(n, n));
    if (!inverse) return prior;
    information += *inverse;
  }
  if (const auto inverse = definite_inverse(information))
    prior.noise = static_cast<double>(start.mode_count()) * *inverse;
  return prior;
}

/// Replaces the fit, and its splits, by those with unknown states, if the left-out runs do not lose by it.
void take(const RefineInput& in, const CrossValidation& validation, Fit& fit, MeasurementStage& stage) {
  LearnedBank changed = maximise_measured(in, in.all, with_R_out_of_Q(in, fit.learned.bank), in.options.max_iterations);
  if (validation.possible()) {
    std::vector<Bank> banks = fit.of_splits;
    tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t s) {
      banks[s] =
          maximise_measured(in, validation.learning()[s], with_R_out_of_Q(in, banks[s]), in.options.max_iterations)
              .bank;
    });
    stage.score_before = stage.score = validation.mean_score(validation.scores(fit.of_splits));
    const double after = validation.mean_score(validation.scores(banks));
    if (!std::isfinite(after) || after < stage.score_before - least_gain) return;
    stage.score = after;
    fit.of_splits = std::move(banks);
  }
  fit.learned = std::move(changed);
}

}  // namespace

Bank with_R_out_of_Q(const RefineInput& in, Bank bank) {
  constexpr double least_share = 0.1;  // of Q that stays
  constexpr double start_of_R = 0.05;  // share of Q, where the single model has no R: modes may hide it
  const Index n = bank.structure.states;
  if (in.estimates_R()) {
    Eigen::VectorXd R = bank.R.diagonal().cwiseMax(in.single.R);
    for (const Mode& mode : bank.modes) R = R.cwiseMax(start_of_R * mode.weight * mode.Q.diagonal().head(n));
    bank.R.diagonal() = R;
  }
  for (Mode& mode : bank.modes) {
    auto Q = mode.Q.topLeftCorner(n, n);
    const Eigen::VectorXd left = (Q.diagonal() - bank.R.diagonal()).cwiseMax(least_share * Q.diagonal());
    const Eigen::VectorXd scale = left.cwiseQuotient(Q.diagonal()).cwiseSqrt();
    Q = (scale.asDiagonal() * Q * scale.asDiagonal()).eval();
  }
  return bank;
}

LearnedBank maximise_measured(const RefineInput& in, const LearningRuns& runs, const Bank& start, Index iterations) {
  const SwitchingPrior prior = prior_with_states_unknown(in.prior(runs), start);
  const ModePosterior posterior = smooth_modes(runs.transitions, switching_model(start));
  const FreeParameters free =
      all_parameters(with_complete_errors(runs.transitions, posterior, prior, start), in.estimates_R(), in.least_R());
  const LikelihoodTarget target{runs.recording, {}, prior};
  LikelihoodMaximum maximum = maximise_likelihood(target, free, start, {iterations, in.options.tolerance});
  // An R that the likelihood does not see is the least one: rounding would decide its digits.
  Bank least = maximum.bank;
  if (in.estimates_R()) least.R = least.R.cwiseMin(Eigen::MatrixXd(free.least_R.asDiagonal()));
  const double samples = static_cast<double>(runs.recording.transitions(Role::train));
  if (const double value = target.value(least); value > maximum.value - in.options.tolerance * samples) {
    maximum.bank = std::move(least);
    maximum.value = value;
  }
  const double likelihood = maximum.value - target.log_prior(maximum.bank);
  return {std::move(maximum.bank), prior, likelihood, maximum.iterations, maximum.end};
}

Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, Fit fit,
                               MeasurementStage& stage) {
  // Where left-out runs decide, they have already preferred the exact states.
  const bool undecided = in.unknown_states && !validation.possible();
  if (fit.exact() && (undecided || !fit.learned.bank.R.isZero(0.0))) {
    take(in, validation, fit, stage);
  } else if (!fit.exact()) {
    stage.score = validation.mean_score(fit.scores);
    fit.learned = maximise_measured(in, in.all, fit.learned.bank, in.options.max_iterations);
  }
  stage.iterations = fit.learned.iterations;
  stage.end = fit.learned.end;
  return fit;
}

}  // namespace modebank
