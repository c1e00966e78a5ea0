#include "filter/learn/refine/state_dependent_transition.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/mode_screening.hpp"
#include "filter/learn/switching/transition_regression.hpp"
#include "filter/learn/tuning.hpp"

namespace modebank {
namespace {

/// A model with a logit, fitted to all training runs.
struct LogitStart {
  const Fit* constant;  ///< the fit with constant T from which this model started; its priors are kept
  SwitchingRegression model;
  double log_likelihood;
};

LogitStart gone_on(const RefineInput& in, const Fit& constant, SwitchingRegression model) {
  const SwitchingPrior prior = with_logit_prior(in.prior(constant.start), in.transitions, {refine_tuning.weight_width});
  ExpectationMaximisation em(in.transitions, prior, em_options(in.options), std::move(model));
  for (Index i = 0; i < in.options.max_iterations && !em.converged(); ++i) em.step();
  return {&constant, em.model(), em.posterior().log_likelihood};
}

/// Continues every start's fit with constant T as a logit. Empty for one mode, which does not switch.
std::vector<LogitStart> from_constant_fits(const RefineInput& in, const std::vector<Fit>& fits) {
  std::vector<std::optional<LogitStart>> all(fits.size());
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t f) {
    SwitchingRegression model = fit_training_runs(in, fits[f].model, in.prior(fits[f].start), fits[f].iterations).model;
    if (model.modes() == 1) return;
    model.logit = no_effect(in.transitions, model.modes());
    all[f] = gone_on(in, fits[f], std::move(model));
  });
  std::vector<LogitStart> starts;
  for (std::optional<LogitStart>& start : all)
    if (start) starts.push_back(std::move(*start));
  return starts;
}

bool likelier(const LogitStart& a, const LogitStart& b) { return a.log_likelihood > b.log_likelihood; }

/// The most likely model of each number of modes, the most modes first. The candidates are the continued fits with
/// constant T. Further candidates come from the best of these fits, by merging one pair of modes after another.
std::vector<LogitStart> logit_starts(const RefineInput& in, const std::vector<Fit>& fits) {
  std::vector<LogitStart> all = from_constant_fits(in, fits);
  if (all.empty()) return all;
  LogitStart last = *std::min_element(all.begin(), all.end(), likelier);
  while (last.model.modes() > 2) {
    const ModePosterior posterior = smooth_modes(in.transitions, last.model);
    last = gone_on(in, *last.constant, with_closest_pair_merged(in.transitions, posterior, last.model));
    all.push_back(last);
  }
  std::sort(all.begin(), all.end(), likelier);
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.model.modes() > b.model.modes(); });
  const auto as_many = [](const auto& a, const auto& b) { return a.model.modes() == b.model.modes(); };
  all.erase(std::unique(all.begin(), all.end(), as_many), all.end());
  return all;
}

/// Continues from a start on every split, and chooses the best number of iterations.
Fit scored(const RefineInput& in, const CrossValidation& validation, const LogitStart& start, const LogitPrior& prior) {
  const std::vector<SplitData>& splits = validation.splits();
  std::vector<SwitchingPrior> priors;
  for (const SplitData& split : splits)
    priors.push_back(with_logit_prior(prior_of_split(in, split, start.constant->start), split.transitions, prior));
  SplitFits fits(in, splits, std::move(priors), std::vector<SwitchingRegression>(splits.size(), start.model));
  Fit best = *start.constant;
  best.model = start.model;
  best.logit_prior = prior;
  best.iterations = 0;
  for (const Index checkpoint : refine_tuning.checkpoints) {
    if (checkpoint > in.options.max_iterations) break;
    fits.advance_to(checkpoint);
    std::vector<Bank> banks = fits.banks();
    LeftOutScores scores = validation.scores(banks);
    if (best.iterations == 0 || scores.log_likelihood.sum() > best.scores.log_likelihood.sum()) {
      best.iterations = checkpoint;
      best.scores = std::move(scores);
      best.of_splits = std::move(banks);
    }
    if (fits.converged()) break;
  }
  return best;
}

bool higher(const Fit& a, const Fit& b) { return a.scores.log_likelihood.sum() > b.scores.log_likelihood.sum(); }

}  // namespace

std::optional<Fit> choose_state_dependent_transition(const RefineInput& in, const CrossValidation& validation,
                                                     SwitchingStage& stage) {
  if (!validation.possible()) return std::nullopt;
  const RefineTuning& tuning = refine_tuning;
  std::vector<Fit> sizes;
  std::vector<LeftOutScores> scores;
  const std::vector<Fit> constant = validation.best_of_starts();
  const std::vector<LogitStart> starts = logit_starts(in, constant);
  for (const LogitStart& start : starts) {
    sizes.push_back(scored(in, validation, start, {tuning.weight_width}));
    scores.push_back(sizes.back().scores);
  }
  if (sizes.empty()) return std::nullopt;
  const std::size_t size = fewest_modes_as_good(scores, validation.samples(), tuning);
  Fit best = sizes[size];
  for (const double width : tuning.other_weight_widths)
    if (Fit other = scored(in, validation, starts[size], {width}); higher(other, best)) best = std::move(other);
  Fit memoryless = scored(in, validation, starts[size], {best.logit_prior.width, tuning.little_memory_sd});
  if (as_good(memoryless.scores, best.scores, validation.samples(), tuning)) best = std::move(memoryless);

  const LeftOutScores& without = validation.chosen().scores;
  const PairedLoss gain = paired_loss(best.scores.log_likelihood, without.log_likelihood, validation.samples());
  stage.score_before = without.log_likelihood.sum() / validation.samples().sum();
  stage.gain = gain.mean;
  stage.gain_standard_error = gain.standard_error;
  if (!is_worth_it(gain, validation.samples())) return std::nullopt;
  stage.width = best.logit_prior.width;
  stage.memory_sd = best.logit_prior.memory_sd;
  return best;
}

}  // namespace modebank
