#include "filter/learn/refine/measurement_noise.hpp"

#include <tbb/parallel_for.h>

#include <chrono>
#include <cmath>
#include <numeric>
#include <utility>

#include "filter/learn/likelihood/information.hpp"
#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/switching/shrinkage.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "ident/base/linalg.hpp"

namespace modebank {
namespace {

// The search for R alone: its end is where the fit of everything begins.
constexpr AscentLimits search_limits{30, 1e-7};

/// R = `share` of the mean Q, taken out of Q: white measurement noise of variance r enters a residual of exact states
/// about twice.
Bank with_share_as_R(Bank bank, double share) {
  const Index n_y = bank.R.rows();
  Eigen::VectorXd mean_Q = Eigen::VectorXd::Zero(n_y);
  for (const Mode& mode : bank.modes) mean_Q += mode.weight * mode.Q.diagonal().head(n_y);
  bank.R = (share * mean_Q).asDiagonal();
  for (Mode& mode : bank.modes) mode.Q *= 1.0 - 2.0 * share;
  return bank;
}

/// R of every output and one factor on Q.
FreeParameters free_noise(Index n_y) {
  FreeParameters free;
  free.Q_by_one_factor = true;
  free.R.resize(static_cast<std::size_t>(n_y));
  std::iota(free.R.begin(), free.R.end(), Index{0});
  free.least_R = Eigen::VectorXd::Zero(n_y);
  free.transition = false;
  return free;
}

/// Whether a step of Newton's method from `start`, by the information of single samples, leads above `level`.
bool promises(const LikelihoodTarget& target, const FreeParameters& free, const Bank& start, double level) {
  const BankCoordinates around(start, free);
  const SampleGradients gradients = sample_gradients(around, Eigen::VectorXd::Constant(around.size(), difference_step),
                                                     target.recording, target.filter);
  const Cholesky information(gradients.information);
  if (!information.definite() || !gradients.sum.allFinite()) return false;
  return target.value(start) + 0.5 * information.whiten(gradients.sum).squaredNorm() > level;
}

/// The fit that took the state as measured exactly has its theta drawn to errors in variables, at times so far that
/// with this theta no R is likelier than none. Then theta is searched with R and one factor on Q, if the gradient
/// promises anything. Empty where that does not lead above the bank by least_gain per sample either. `transitions`: of
/// the target's recording.
std::optional<Bank> estimate_with_theta(const LikelihoodTarget& target, const RefineInput& in,
                                        const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                        const Bank& bank) {
  const RefineTuning& tuning = in.options.tuning;
  const SwitchingSums sums = sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), prior);
  FreeParameters free = free_noise(bank.R.rows());
  free.theta_unit =
      all_parameters(bank, sums, prior, in.options.one_theta, false, least_measurement_noise(in.fits, tuning))
          .theta_unit;
  const double level =
      target.value(bank) + tuning.least_gain * static_cast<double>(target.recording.transitions(Role::train));
  const Bank start = with_share_as_R(bank, tuning.R_start_share_with_theta);
  if (!promises(target, free, start, level)) return std::nullopt;
  LikelihoodMaximum end = maximise_likelihood(target, free, start, search_limits);
  if (!(std::isfinite(end.value) && end.value > level)) return std::nullopt;
  return std::move(end.bank);
}

/// Whether R is estimated. Of rounded states it is held: what they differ by from the states is in the likelihood of
/// their intervals already.
bool estimates_R(const RefineInput& in, const Bank& bank) {
  return in.options.measurement_noise && !bank.is_quantised();
}

/// Theta, Q, T and (where it is to be estimated) R of a bank together, from there to the maximum on these runs.
LikelihoodMaximum maximise_everything(const LikelihoodTarget& target, const RefineInput& in,
                                      const TrainingTransitions& transitions, const Bank& bank) {
  const SwitchingSums sums =
      sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), *target.prior);
  const FreeParameters free = all_parameters(bank, sums, *target.prior, in.options.one_theta, estimates_R(in, bank),
                                             least_measurement_noise(in.fits, in.options.tuning));
  return maximise_likelihood(target, free, bank, {in.options.max_iterations, in.options.tolerance});
}

/// The fits to the splits' training runs as measurement noise enters them. Nothing of a fit has seen the runs it is
/// scored on: not theta and T, nor R or the prior.
class MeasuredSplits {
 public:
  MeasuredSplits(const RefineInput& in, const CrossValidation& validation, const ChosenFit& chosen,
                 const NoiseAdaptation& adaptation)
      : in_(in), validation_(validation), chosen_(chosen), banks_(chosen.of_splits) {
    for (Bank& bank : banks_) bank.noise_adaptation = adaptation;
  }

  /// Mean log score of the runs left out.
  double score() const { return validation_.score(banks_); }

  /// R of each split; a split may ask for none.
  void estimate_R() {
    for_each([&](const SplitData& split, Bank& bank) {
      const LikelihoodTarget target{split.runs.training, in_.filter, std::nullopt};
      MeasurementNoise noise = estimate_measurement_noise(target, bank, in_.options.tuning);
      if (!noise.bank)
        noise.bank = estimate_with_theta(target, in_, split.transitions,
                                         prior_of_split(in_, split, chosen_.noise_transitions), bank);
      if (noise.bank) bank = std::move(*noise.bank);
    });
  }

  void maximise() {
    for_each([&](const SplitData& split, Bank& bank) {
      SwitchingPrior exact = prior_of_split(in_, split, chosen_.noise_transitions);
      exact = towards_one_motion(std::move(exact), split.transitions, switching_model(bank), chosen_.theta_transitions,
                                 in_.options.tuning);
      if (chosen_.weight_width > 0.0) exact = with_weights(std::move(exact), split.transitions, chosen_.weight_width);
      const LikelihoodTarget target{split.runs.training, learning_filter(in_.filter),
                                    prior_with_states_unknown(exact, bank, in_.options.tuning), in_.options.one_theta};
      bank = maximise_everything(target, in_, split.transitions, bank).bank;
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
  const ChosenFit& chosen_;
  std::vector<Bank> banks_;
};

}  // namespace

MeasurementNoise estimate_measurement_noise(const LikelihoodTarget& target, const Bank& bank,
                                            const RefineTuning& tuning) {
  std::vector<LikelihoodMaximum> ends(tuning.R_start_shares.size());
  tbb::parallel_for(std::size_t{0}, ends.size(), [&](std::size_t i) {
    ends[i] = maximise_likelihood(target, free_noise(bank.R.rows()), with_share_as_R(bank, tuning.R_start_shares[i]),
                                  search_limits);
  });
  MeasurementNoise result;
  result.starts = std::ssize(ends);
  const double transitions = static_cast<double>(target.recording.transitions(Role::train));
  LikelihoodMaximum* best = nullptr;
  for (LikelihoodMaximum& end : ends) {
    if (!std::isfinite(end.value) || !end.rose) {
      ++result.failed_starts;
      continue;
    }
    // Ends that differ by less than they are searched to are one.
    if (!best || end.value > best->value + search_limits.tolerance * transitions) best = &end;
  }
  if (best && best->value > target.value(bank) + tuning.least_gain * transitions) result.bank = std::move(best->bank);
  return result;
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

MeasuredBank fit_untimed(const RefineInput& in, const CrossValidation& validation, const ChosenFit& chosen,
                         const SwitchingPrior& prior, const Bank& bank) {
  const RefineTuning& tuning = in.options.tuning;
  MeasuredBank result{bank, {}, prior};
  MeasurementStage& stage = result.stage;
  std::optional<MeasuredSplits> splits;
  if (validation.possible()) splits.emplace(in, validation, chosen, bank.noise_adaptation);
  if (estimates_R(in, bank)) {
    MeasurementNoise noise = estimate_measurement_noise({in.recording, in.filter, std::nullopt}, bank, tuning);
    stage.starts = noise.starts;
    stage.failed_starts = noise.failed_starts;
    if (!noise.bank)
      noise.bank = estimate_with_theta({in.recording, in.filter, std::nullopt}, in, in.transitions, prior, bank);
    if (!noise.bank) return result;
    if (splits) {
      const double without_R = splits->score();
      splits->estimate_R();
      if (splits->score() < without_R - tuning.least_gain) return result;
    }
    result.bank = std::move(*noise.bank);
    result.R_estimated = true;
  } else if (!bank.is_quantised() &&
             !(bank.R.diagonal().array() > least_measurement_noise(in.fits, tuning).array()).any()) {
    return result;
  }
  result.prior = prior_with_states_unknown(prior, result.bank, tuning);
  if (splits) {
    stage.score_before = splits->score();
    splits->maximise();
    stage.score = splits->score();
    if (stage.score < stage.score_before - tuning.least_gain) {
      stage.score = stage.score_before;
      return result;
    }
  }
  const LikelihoodTarget target{in.recording, learning_filter(in.filter), result.prior, in.options.one_theta};
  LikelihoodMaximum maximum = maximise_everything(target, in, in.transitions, result.bank);
  stage.iterations = maximum.iterations;
  stage.end = maximum.end;
  result.bank = std::move(maximum.bank);
  return result;
}

}  // namespace

MeasuredBank fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation,
                                        const ChosenFit& chosen, const SwitchingPrior& prior, const Bank& bank) {
  const auto start = std::chrono::steady_clock::now();
  MeasuredBank result = fit_untimed(in, validation, chosen, prior, bank);
  result.stage.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace modebank
