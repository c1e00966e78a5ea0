#include "filter/learn/refine/guards.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/switching/transition_regression.hpp"

namespace modebank {
namespace {

/// One fit after another number of iterations with the same logit, on every split.
class SplitGuards {
 public:
  SplitGuards(const RefineInput& in, const CrossValidation& validation, const ScoredFit& constant, double width)
      : in_(in), splits_(validation.splits()), fits_(splits_.size()) {
    for (const SplitData& split : splits_)
      priors_.push_back(with_weights(prior_of_split(in, split, constant.start), split.transitions, width));
    tbb::parallel_for(std::size_t{0}, splits_.size(), [&](std::size_t s) {
      SwitchingRegression start = switching_model(constant.banks[s]);
      start.logit = no_effect(splits_[s].transitions, start.modes());
      fits_[s] = std::make_unique<ExpectationMaximisation>(splits_[s].transitions, priors_[s], em_options(in.options),
                                                           std::move(start));
    });
  }

  void advance(Index iterations) {
    tbb::parallel_for(std::size_t{0}, fits_.size(), [&](std::size_t s) {
      for (Index i = 0; i < iterations && !fits_[s]->converged(); ++i) fits_[s]->step();
    });
  }
  bool converged() const {
    return std::all_of(fits_.begin(), fits_.end(), [](const auto& fit) { return fit->converged(); });
  }
  std::vector<Bank> banks() const {
    std::vector<Bank> banks;
    for (const auto& fit : fits_) banks.push_back(with_modes(in_.frame, fit->model()));
    return banks;
  }

 private:
  const RefineInput& in_;
  const std::vector<SplitData>& splits_;
  std::vector<SwitchingPrior> priors_;
  std::vector<std::unique_ptr<ExpectationMaximisation>> fits_;
};

/// The best number of iterations of one fit and width.
Guards scored(const RefineInput& in, const CrossValidation& validation, const ScoredFit& constant, double width) {
  SplitGuards fits(in, validation, constant, width);
  Guards best{constant, width, 0};
  Index done = 0;
  for (const Index checkpoint : in.options.tuning.checkpoints) {
    if (checkpoint > in.options.max_iterations) break;
    fits.advance(checkpoint - std::exchange(done, checkpoint));
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

/// The best fit of every number of modes but one.
std::vector<ScoredFit> best_of_each_size(const CrossValidation& validation) {
  std::vector<ScoredFit> fits;
  for (ScoredFit& fit : validation.best_of_starts()) {
    const auto as_many = [&](const ScoredFit& f) { return f.start.model.modes() == fit.start.model.modes(); };
    if (fit.start.model.modes() > 1 && std::none_of(fits.begin(), fits.end(), as_many)) fits.push_back(std::move(fit));
  }
  return fits;
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
  for (const ScoredFit& fit : best_of_each_size(validation)) {
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

TrainingFit fit_guards(const RefineInput& in, const Guards& guards, const SwitchingPrior& prior,
                       const TrainingFit& constant) {
  RefineStart start = guards.fit.start;
  start.model = constant.model;
  start.model.logit = no_effect(in.transitions, start.model.modes());
  TrainingFit fit = fit_training_runs(in, start, prior, guards.iterations);
  fit.model.logit.weights.rowwise() -= fit.model.logit.weights.colwise().mean().eval();  // changes no probability
  fit.screened.insert(fit.screened.begin(), constant.screened.begin() + std::ssize(in.frame.screened),
                      constant.screened.end());
  return fit;
}

}  // namespace modebank
