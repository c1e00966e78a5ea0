#include "filter/learn/refine/cross_validation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/switching/logit.hpp"
#include "filter/learn/switching/screening.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/fit/global_model.hpp"

namespace modebank {
namespace {

std::vector<Index> checkpoints_up_to(Index limit) {
  std::vector<Index> list;
  for (const Index checkpoint : refine_tuning.checkpoints)
    if (checkpoint < limit) list.push_back(checkpoint);
  list.push_back(limit);
  return list;
}

std::vector<LeftOutScores> scores_of(const std::vector<Fit>& fits) {
  std::vector<LeftOutScores> scores;
  for (const Fit& fit : fits) scores.push_back(fit.scores);
  return scores;
}

SwitchingPrior prior_of(const RefineInput& in, const RefineStart& start, const TrainingTransitions& transitions,
                        const GlobalModel& global) {
  return with_logit_prior(switching_prior(transitions, global, in.fits.prior_sd, start.noise_transitions), transitions,
                          start.logit_width);
}

}  // namespace

SwitchingPrior RefineInput::prior(const RefineStart& start) const {
  return prior_of(*this, start, transitions, fits.global);
}

SwitchingEmOptions RefineInput::em() const {
  return {options.one_theta, options.tolerance, refine_tuning.alternations};
}

Eigen::VectorXd RefineInput::least_R() const { return refine_tuning.least_R_share * fits.global.noise_variance(); }

SwitchingPrior SplitData::prior(const RefineInput& in, const RefineStart& start) const {
  return prior_of(in, start, transitions, global);
}

TrainingFit fit_training_runs(const RefineInput& in, const RefineStart& start, Index iterations) {
  const SwitchingPrior prior = in.prior(start);
  ExpectationMaximisation em(in.transitions, prior, in.em(), start.model);
  for (Index i = 0; i < iterations && !em.converged(); ++i) em.step();
  TrainingFit fit{em.model(), em.posterior(), in.frame.screened, em.objective()};
  while (in.options.screen) {
    std::optional<ScreenedModel> rest =
        without_worst_mode(in.transitions, fit.posterior, fit.model, in.options.one_theta);
    if (!rest) break;
    fit.screened.push_back(std::move(rest->mode));
    ExpectationMaximisation others(in.transitions, prior, in.em(), std::move(rest->model));
    for (Index i = 0; i < refine_tuning.iterations_after_screening; ++i) others.step();
    fit.model = others.model();
    fit.posterior = others.posterior();
  }
  return fit;
}

CrossValidation::CrossValidation(const RefineInput& in) : in_(in) {
  std::vector<double> samples;
  for (ValidationSplit& split : validation_splits(in.recording, in.options.folds)) {
    for (const Trajectory& run : split.left_out.runs) samples.push_back(static_cast<double>(run.transitions()));
    Bank frame = in.frame;
    if (in.options.noise_by_input && !frame.noise_factor.empty())
      frame.noise_factor = fit_noise_factor(split.training, frame.structure);
    TrainingTransitions transitions = gather_training_transitions(split.training, frame.structure, frame.noise_factor);
    GlobalModel global = fit_global(split.training, in.frame.structure);
    splits_.push_back({std::move(split), std::move(frame), std::move(transitions), std::move(global)});
  }
  samples_ = Eigen::Map<const Eigen::VectorXd>(samples.data(), std::ssize(samples));
}

void CrossValidation::consider(const std::vector<RefineStart>& candidates) {
  WorkCounter counter("fits of modes", candidates.size());
  for (const RefineStart& start : candidates) {
    fits_.push_back(possible() ? best_iterations(start) : Fit{start});
    if (!possible()) fits_.back().iterations = in_.options.max_iterations;
    fits_.back().row = fits_.size() - 1;
    counter.add();
  }
  if (possible()) chosen_ = fewest_modes_as_good(scores_of(fits_), samples_, refine_tuning);
}

Fit CrossValidation::best_iterations(const RefineStart& start) const {
  std::vector<SwitchingPrior> priors;
  for (const SplitData& split : splits_) priors.push_back(split.prior(in_, start));
  std::vector<std::optional<ExpectationMaximisation>> fits(splits_.size());
  tbb::parallel_for(std::size_t{0}, fits.size(),
                    [&](std::size_t s) { fits[s].emplace(splits_[s].transitions, priors[s], in_.em(), start.model); });
  Fit best{start};
  best.scores.modes = start.model.modes();
  Index done = 0;
  int falls = 0;
  for (const Index checkpoint : checkpoints_up_to(in_.options.max_iterations)) {
    tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t s) {
      for (Index i = done; i < checkpoint && !fits[s]->converged(); ++i) fits[s]->step();
    });
    done = checkpoint;
    std::vector<Bank> banks;
    for (std::size_t s = 0; s < fits.size(); ++s) banks.push_back(with_modes(splits_[s].frame, fits[s]->model()));
    LeftOutScores of_banks = scores(banks);
    const double gain = mean_score(of_banks) - mean_score(best.scores);
    falls = gain < -refine_tuning.least_gain ? falls + 1 : 0;
    if (best.iterations == 0 || gain > 0.0) {
      best.iterations = checkpoint;
      best.scores = std::move(of_banks);
      best.of_splits = std::move(banks);
    }
    if (falls == refine_tuning.falls) break;
    if (std::all_of(fits.begin(), fits.end(), [](const auto& fit) { return fit->converged(); })) break;
  }
  return best;
}

std::vector<RefineCandidate> CrossValidation::table(std::size_t selected) const {
  const std::size_t best = possible() ? best_candidate(scores_of(fits_)) : 0;
  std::vector<RefineCandidate> rows;
  for (const Fit& fit : fits_) {
    RefineCandidate row{fit.start.name, fit.start.model.modes(), fit.start.noise_transitions, fit.iterations};
    if (possible()) {
      const PairedLoss loss = paired_loss(fits_[best].scores.log_likelihood, fit.scores.log_likelihood, samples_);
      row.score = mean_score(fit.scores);
      row.loss = loss.mean;
      row.loss_standard_error = loss.standard_error;
    }
    rows.push_back(row);
  }
  rows[selected].selected = true;
  return rows;
}

std::vector<Fit> CrossValidation::best_of_starts() const {
  std::vector<Fit> fits;
  const auto same_start = [](const RefineStart& a, const RefineStart& b) {
    return a.name == b.name && a.model.modes() == b.model.modes();
  };
  for (const Fit& fit : fits_) {
    const auto known =
        std::find_if(fits.begin(), fits.end(), [&](const Fit& f) { return same_start(f.start, fit.start); });
    if (known == fits.end())
      fits.push_back(fit);
    else if (mean_score(fit.scores) > mean_score(known->scores))
      *known = fit;
  }
  std::sort(fits.begin(), fits.end(), [&](const Fit& a, const Fit& b) {
    const double better = mean_score(a.scores) - mean_score(b.scores);
    return better > 0.0 || (!(better < 0.0) && a.row < b.row);
  });
  return fits;
}

LeftOutScores CrossValidation::scores(const std::vector<Bank>& banks) const {
  std::vector<const Bank*> bank_of;
  std::vector<const Trajectory*> runs;
  for (std::size_t s = 0; s < splits_.size(); ++s)
    for (const Trajectory& run : splits_[s].runs.left_out.runs) {
      bank_of.push_back(&banks[s]);
      runs.push_back(&run);
    }
  LeftOutScores result{banks.front().mode_count(), Eigen::VectorXd(std::ssize(runs))};
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    result.log_likelihood(static_cast<Index>(i)) = log_likelihood(*bank_of[i], *runs[i], in_.filter);
  });
  return result;
}

double CrossValidation::mean_score(const LeftOutScores& scores) const {
  const double sum = scores.log_likelihood.sum();
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum / samples_.sum();
}

}  // namespace modebank
