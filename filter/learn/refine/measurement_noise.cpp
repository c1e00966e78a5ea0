#include "filter/learn/refine/measurement_noise.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "filter/learn/likelihood/information.hpp"
#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/work_counter.hpp"

namespace modebank {
namespace {

// Options for the search for R alone. The fit of all parameters starts where this search ends.
constexpr AscentLimits search_limits{30, 1e-7};

/// Smallest increase of the log-likelihood of these training runs that R must give [nats].
double least_rise(const LikelihoodTarget& target) {
  const auto samples = static_cast<double>(target.recording.transitions(Role::train));
  return samples * refine_tuning.least_gain;
}

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

/// The free parameters are R of every output and one factor on Q.
FreeParameters free_noise(const Bank& bank) {
  FreeParameters free;
  free.Q_by_one_factor = true;
  free.R.resize(static_cast<std::size_t>(bank.R.rows()));
  std::iota(free.R.begin(), free.R.end(), Index{0});
  free.least_R = bank.rounding_variance();
  free.transition = false;
  return free;
}

/// Whether a Newton step from `start` is expected to gain more than `level`. The step uses the information of single
/// samples.
bool promises(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start, double level) {
  const BankCoordinates around(start, free);
  const SampleGradients gradients = sample_gradients(around, Eigen::VectorXd::Constant(around.size(), difference_step),
                                                     target.recording, target.filter);
  const Cholesky information(gradients.information);
  if (!information.definite() || !gradients.sum.allFinite()) return false;
  return target.value(start) + 0.5 * information.whiten(gradients.sum).squaredNorm() > level;
}

/// With more states than this, a filter pass is slow. Then R is searched from one start. theta is searched, too, only
/// if it has few coordinates.
constexpr Index most_states_of_wide_search = 4, most_coordinates_of_large_filters = 40;

bool is_large(const Bank& bank) { return bank.structure.dimension() > most_states_of_wide_search; }

/// Starting shares. Usually all shares in the tuning; for a large filter only the most likely share, if its gradient
/// promises a gain.
std::vector<Bank> starts_of_R(const LikelihoodTarget& target, const FreeParameters& free, const Bank& bank,
                              double level, const RefineTuning& tuning) {
  std::vector<Bank> starts;
  for (const double share : tuning.R_start_shares) starts.push_back(with_share_as_R(bank, share));
  if (!is_large(bank)) return starts;
  Bank likeliest = *std::max_element(starts.begin(), starts.end(), [&](const Bank& a, const Bank& b) {
    return is_below(target.value(a), target.value(b));
  });
  starts.clear();
  if (promises(target, free, likeliest, level)) starts.push_back(std::move(likeliest));
  return starts;
}

/// Searches theta with R and one factor on Q, if the gradient promises a gain. The reason: theta of exactly measured
/// states is biased by errors in variables, and with this theta R = 0 may be most likely. Empty if this search also
/// gains less than least_rise over the bank. `transitions`: transitions of the target's recording.
std::optional<Bank> estimate_with_theta(const LikelihoodTarget& target, const RefineInput& in,
                                        const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                        const Bank& bank) {
  const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), prior);
  FreeParameters free = free_noise(bank);
  free.theta_unit = all_parameters(bank, sums, prior, in.options.one_theta, false, {}).theta_unit;
  if (is_large(bank) && BankCoordinates(bank, free).size() > most_coordinates_of_large_filters) return std::nullopt;
  const double level = target.value(bank) + least_rise(target);
  const Bank start = with_share_as_R(bank, refine_tuning.R_start_share_with_theta);
  if (!promises(target, free, start, level)) return std::nullopt;
  LikelihoodMaximum end = maximise_likelihood(target, free, start, search_limits);
  if (!(std::isfinite(end.value) && end.value > level)) return std::nullopt;
  return std::move(end.bank);
}

/// Maximises the target on these runs over theta, Q, T and (`with_R`) R of a bank together.
LikelihoodMaximum maximise_everything(const LikelihoodTarget& target, const RefineInput& in,
                                      const TrainingTransitions& transitions, const Bank& bank, bool with_R) {
  const SwitchingSums sums =
      sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), *target.prior);
  const FreeParameters free = all_parameters(bank, sums, *target.prior, in.options.one_theta, with_R,
                                             least_measurement_noise(in.fits, refine_tuning));
  return maximise_likelihood(target, free, bank, {in.options.max_iterations, in.options.tolerance});
}

/// R of a bank. It comes from the search for R alone. If the theta of exact states makes R = 0 most likely, R is
/// searched together with theta.
MeasurementNoise find_R(const LikelihoodTarget& target, const RefineInput& in, const TrainingTransitions& transitions,
                        const SwitchingPrior& prior, const Bank& bank) {
  MeasurementNoise noise = estimate_measurement_noise(target, bank, refine_tuning);
  if (!noise.bank) noise.bank = estimate_with_theta(target, in, transitions, prior, bank);
  return noise;
}

/// The fits to the training runs of the splits, with measurement noise. No part of a fit (theta, T, R, prior) uses the
/// runs that are scored with it.
class MeasuredSplits {
 public:
  MeasuredSplits(const RefineInput& in, const CrossValidation& validation, const Fit& exact)
      : in_(in), validation_(validation), exact_(exact), banks_(exact.of_splits) {}

  const std::vector<Bank>& banks() const { return banks_; }
  /// Mean log score of the left-out runs.
  double score() const { return validation_.mean_score(validation_.scores(banks_)); }

  /// Estimates R of each split; R may be zero for some splits.
  void estimate_R() {
    for_each([&](const SplitData& split, Bank& bank) {
      const LikelihoodTarget target{split.runs.training, in_.filter, std::nullopt};
      MeasurementNoise noise =
          find_R(target, in_, split.transitions, prior_of_split(in_, split, exact_.start.noise_transitions), bank);
      if (noise.bank) bank = std::move(*noise.bank);
    });
  }

  void maximise(bool with_R) {
    for_each([&](const SplitData& split, Bank& bank) {
      SwitchingPrior exact = prior_of_split(in_, split, exact_.start.noise_transitions);
      exact = towards_one_motion(std::move(exact), split.transitions, switching_model(bank),
                                 exact_.start.theta_transitions, refine_tuning);
      exact = with_logit_prior(std::move(exact), split.transitions, exact_.logit_prior);
      const LikelihoodTarget target{split.runs.training, learning_filter,
                                    prior_with_states_unknown(exact, bank, refine_tuning), in_.options.one_theta};
      bank = maximise_everything(target, in_, split.transitions, bank, with_R).bank;
    });
  }

 private:
  template <class Change>
  void for_each(Change change) {
    tbb::parallel_for(std::size_t{0}, banks_.size(),
                      [&](std::size_t s) { change(validation_.splits()[s], banks_[s]); });
  }

  const RefineInput& in_;
  const CrossValidation& validation_;
  const Fit& exact_;
  std::vector<Bank> banks_;
};

}  // namespace

MeasurementNoise estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                            const RefineTuning& tuning) {
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  const double level = target.value(bank) + least_rise(target);
  const FreeParameters free = free_noise(bank);
  const std::vector<Bank> starts = starts_of_R(target, free, bank, level, tuning);
  std::vector<LikelihoodMaximum> ends(starts.size());
  WorkCounter counter("searches for measurement noise", ends.size());
  tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t i) {
    ends[i] = maximise_likelihood(target, free, starts[i], search_limits);
    counter.add();
  });
  MeasurementNoise result;
  result.starts = std::ssize(tuning.R_start_shares);
  LikelihoodMaximum* best = nullptr;
  for (LikelihoodMaximum& end : ends) {
    if (!std::isfinite(end.value) || !end.rose) {
      ++result.failed_starts;
      continue;
    }
    // Results that differ by less than the search tolerance count as equal.
    if (!best || end.value > best->value + search_limits.tolerance * transitions) best = &end;
  }
  if (best && best->value > level) result.bank = std::move(best->bank);
  return result;
}

bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R) {
  const auto has = [&](const Bank& bank) { return 10.0 * bank.R.trace() >= R.trace(); };
  return 2 * std::count_if(banks.begin(), banks.end(), has) >= std::ssize(banks);
}

SwitchingPrior prior_with_states_unknown(const SwitchingPrior& exact, const Bank& start, const RefineTuning& tuning) {
  SwitchingPrior prior = exact;
  prior.noise_transitions = tuning.Q_transitions_with_R;
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

namespace {

/// Accepts R, for the bank and the splits, if the data require R and the scores of the left-out runs do not fall. The
/// scores of splits that have no such R do not test it. On ICE no split had it, and one_motion lost 0.19 nats by it.
bool take_R(const RefineInput& in, const SwitchingPrior& exact, std::optional<MeasuredSplits>& splits, Fit& fit,
            MeasurementStage& stage) {
  const LikelihoodTarget target{in.recording, in.filter, std::nullopt};
  MeasurementNoise noise = find_R(target, in, in.transitions, exact, fit.bank);
  stage.starts = noise.starts;
  stage.failed_starts = noise.failed_starts;
  if (!noise.bank) return false;
  if (splits) {
    MeasuredSplits with_R(*splits);
    with_R.estimate_R();
    if (with_R.score() < splits->score() - refine_tuning.least_gain || !mostly_have(with_R.banks(), noise.bank->R))
      return false;
    splits.emplace(std::move(with_R));
  }
  fit.bank = std::move(*noise.bank);
  fit.R_estimated = true;
  return true;
}

/// Continues to the maximum, for the bank and the splits. Returns to the previous fits if the scores of the left-out
/// runs fall.
void go_on(const RefineInput& in, const SwitchingPrior& exact, std::optional<MeasuredSplits>& splits, Fit& fit,
           MeasurementStage& stage) {
  fit.prior = prior_with_states_unknown(exact, fit.bank, refine_tuning);
  if (splits) {
    MeasuredSplits further(*splits);
    further.maximise(fit.R_estimated);
    const double before = splits->score(), after = further.score();
    if (std::isnan(stage.score)) stage.score_before = stage.score = before;
    if (after < before - refine_tuning.least_gain) return;
    stage.score = after;
    splits.emplace(std::move(further));
  }
  const LikelihoodTarget target{in.recording, learning_filter, fit.prior, in.options.one_theta};
  LikelihoodMaximum maximum = maximise_everything(target, in, in.transitions, fit.bank, fit.R_estimated);
  stage.iterations += maximum.iterations;
  stage.end = maximum.end;
  fit.bank = std::move(maximum.bank);
}

Fit fit_untimed(const RefineInput& in, const CrossValidation& validation, const Fit& exact, MeasurementStage& stage) {
  Fit fit = exact;
  std::optional<MeasuredSplits> splits;
  if (validation.possible()) splits.emplace(in, validation, exact);
  // The search for R uses gradients. These ignore that a noise factor changes with the state.
  const bool with_R = in.options.measurement_noise && fit.bank.structure.state_lags <= most_lags_beside_R &&
                      fit.bank.noise_factor.empty();
  const bool quantised = fit.bank.is_quantised();
  const bool asks_for_R = !with_R || quantised || take_R(in, exact.prior, splits, fit, stage);
  if (asks_for_R && (with_R || quantised ||
                     (fit.bank.R.diagonal().array() > least_measurement_noise(in.fits, refine_tuning).array()).any()))
    go_on(in, exact.prior, splits, fit, stage);
  // If states count as exact, Q includes the rounding. Only a fit with R separates rounding from Q.
  if (with_R && quantised && take_R(in, exact.prior, splits, fit, stage)) go_on(in, exact.prior, splits, fit, stage);
  if (splits) fit.of_splits = splits->banks();
  return fit;
}

}  // namespace

Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, const Fit& exact,
                               MeasurementStage& stage) {
  const auto start = std::chrono::steady_clock::now();
  Fit fit = fit_untimed(in, validation, exact, stage);
  stage.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return fit;
}

}  // namespace modebank
