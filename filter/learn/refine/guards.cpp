#include "filter/learn/refine/guards.hpp"

#include <algorithm>
#include <utility>

#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/switching/transition_regression.hpp"

namespace modebank {
namespace {

/// Every split's own fit with a constant T, to go on as a logit whose weights have a prior that wide.
SplitFits logit_fits(const RefineInput& in, const CrossValidation& validation, const ScoredFit& constant,
                     double width) {
  const std::vector<SplitData>& splits = validation.splits();
  std::vector<SwitchingPrior> priors;
  std::vector<SwitchingRegression> starts;
  for (std::size_t s = 0; s < splits.size(); ++s) {
    const TrainingTransitions& transitions = splits[s].transitions;
    priors.push_back(with_weights(prior_of_split(in, splits[s], constant.start), transitions, width));
    starts.push_back(switching_model(constant.banks[s]));
    starts.back().logit = no_effect(transitions, starts.back().modes());
  }
  return {in, splits, std::move(priors), std::move(starts)};
}

/// The best number of iterations of one fit and width.
Guards scored(const RefineInput& in, const CrossValidation& validation, const ScoredFit& constant, double width) {
  SplitFits fits = logit_fits(in, validation, constant, width);
  Guards best{constant, width, 0};
  for (const Index checkpoint : in.options.tuning.checkpoints) {
    if (checkpoint > in.options.max_iterations) break;
    fits.advance_to(checkpoint);
    std::vector<Bank> banks = fits.banks();
    LeftOutScores scores = validation.scores(banks);
    if (best.iterations == 0 || scores.log_likelihood.sum() > best.fit.scores.log_likelihood.sum()) {
      best.iterations = checkpoint;
      best.fit.scores = std::move(scores);
      best.fit.banks = std::move(banks);
    }
    if (fits.converged()) break;
  }
  return best;
}

bool higher(const Guards& a, const Guards& b) {
  return a.fit.scores.log_likelihood.sum() > b.fit.scores.log_likelihood.sum();
}

}  // namespace

std::optional<Guards> choose_guards(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage) {
  if (!validation.possible()) return std::nullopt;
  const RefineTuning& tuning = in.options.tuning;
  std::vector<Guards> sizes;
  std::vector<LeftOutScores> scores;
  for (const ScoredFit& fit : validation.best_of_each_size()) {
    if (fit.start.model.modes() == 1) continue;  // nothing switches
    sizes.push_back(scored(in, validation, fit, tuning.weight_width));
    scores.push_back(sizes.back().fit.scores);
  }
  if (sizes.empty()) return std::nullopt;
  Guards best = sizes[fewest_modes_as_good(scores, validation.samples(), tuning.most_loss)];
  const ScoredFit& constant = validation.of_start(best.fit.row);
  for (const double width : tuning.other_weight_widths)
    if (Guards other = scored(in, validation, constant, width); higher(other, best)) best = std::move(other);

  const LeftOutScores& without = validation.chosen().scores;
  const PairedLoss gain = paired_loss(best.fit.scores.log_likelihood, without.log_likelihood, validation.samples());
  stage = {0.0, without.log_likelihood.sum() / validation.samples().sum(), gain.mean, gain.standard_error};
  if (!(gain.mean > std::max(gain.standard_error, tuning.least_gain))) return std::nullopt;
  stage.width = best.width;
  return best;
}

namespace {

double likelihood_of(const RefineInput& in, const TrainingFit& fit) {
  return training_log_likelihood(with_modes(in.frame, fit.model), in.recording, exact_filter(in.filter));
}

}  // namespace

TrainingFit fit_guards(const RefineInput& in, const Guards& guards, const SwitchingPrior& prior,
                       const TrainingFit& constant) {
  RefineStart start = guards.fit.start;
  start.model = constant.model;
  start.model.logit = no_effect(in.transitions, start.model.modes());
  TrainingFit fit = fit_training_runs(in, start, prior, guards.iterations);
  fit.screened.insert(fit.screened.begin(), constant.screened.begin() + std::ssize(in.frame.screened),
                      constant.screened.end());
  double likelihood = likelihood_of(in, fit);
  const double clearly = in.options.tuning.least_gain * in.transitions.usable.sum();
  for (const Bank& of_split : guards.fit.banks) {
    start.model = switching_model(of_split);
    TrainingFit other = fit_training_runs(in, start, prior, guards.iterations);
    const double others = likelihood_of(in, other);
    if (!(others > likelihood + clearly)) continue;
    likelihood = others;
    fit = std::move(other);
  }
  fit.model.logit.weights.rowwise() -= fit.model.logit.weights.colwise().mean().eval();  // changes no probability
  return fit;
}

}  // namespace modebank
