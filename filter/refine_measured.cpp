#include "filter/refine_measured.hpp"

#include <algorithm>
#include <utility>

#include "filter/definite_inverse.hpp"
#include "filter/refine_noise.hpp"
#include "filter/switching_state_space.hpp"

namespace modebank {
namespace {

constexpr Index most_em_steps = 10;        // quick at first, slow later
constexpr double least_em_gain = 1e-4;     // nats per transition, to go on with them
constexpr double prior_transitions = 1.0;  // unit information

/// Steps that raised the target.
Index climb_by_expectation(const LikelihoodTarget& target, Index limit, Bank& bank) {
  const double least_rise = least_em_gain * static_cast<double>(target.recording.transitions(Role::train));
  double best = target.value(bank);
  Index done = 0;
  for (Bank next = bank; done < limit; ++done) {
    step_state_space(target.recording, target.prior, target.shared, target.filter.time_steps, target.least_R,
                     target.estimate_R, next);
    const double rise = target.value(next) - best;
    if (!(rise > 0.0)) break;
    bank = next;
    best += rise;
    if (rise < least_rise) return done + 1;
  }
  return done;
}

}  // namespace

SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start) {
  SwitchingPrior prior = exact;
  prior.noise_transitions = prior_transitions;
  const Index n = start.structure.states;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
  for (const Mode& mode : start.modes) information += definite_inverse(mode.Q.topLeftCorner(n, n));
  const Eigen::MatrixXd mean = static_cast<double>(start.mode_count()) * definite_inverse(information);
  if (mean.allFinite()) prior.noise = mean;
  return prior;
}

Ascent fit_with_states_unknown(const LikelihoodTarget& target, const AscentLimits& limits, Bank& bank) {
  const Index steps = climb_by_expectation(target, std::min(most_em_steps, limits.max_iterations), bank);
  AscentLimits rest = limits;
  rest.max_iterations -= steps;
  Ascent ascent = raise_likelihood(target, rest, bank);
  ascent.iterations += steps;
  return ascent;
}

FilterOptions learning_filter(const FilterOptions& filter) {
  FilterOptions learning = filter;
  learning.variant = FilterVariant::imm;
  learning.parameter_noise = false;
  return learning;
}

MeasurementStage fit_with_measurement_noise(const RefineOptions& options, const FilterOptions& filter,
                                            const CrossValidation& validation, LikelihoodTarget& target, Bank& bank) {
  const double Q_before = bank.modes.front().Q(0, 0);
  if (target.estimate_R) {
    estimate_measurement_noise(target.recording, filter, bank);
    if (bank.R_standard_error.size() == 0) return {};
  } else if (!(bank.R.diagonal().array() > target.least_R.array()).any()) {
    return {};
  }
  target.prior = prior_with_states_unknown(target.prior, bank);
  Bank fitted = bank;
  const Ascent ascent = fit_with_states_unknown(target, {options.max_iterations, options.tolerance}, fitted);
  MeasurementStage stage{ascent.iterations, ascent.end};
  if (validation.possible()) {
    stage.score_before = validation.score_with_R(bank.R, bank.modes.front().Q(0, 0) / Q_before, bank.noise_adaptation);
    stage.score = validation.score_with_states_unknown(target, fitted);
  }
  if (stage.score < stage.score_before - least_likelihood_gain)
    return {0, MeasuredFit::none, stage.score_before, stage.score_before};
  bank = fitted;
  return stage;
}

}  // namespace modebank
