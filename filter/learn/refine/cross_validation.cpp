#include "filter/learn/refine/cross_validation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/work_counter.hpp"

namespace modebank {
namespace {

std::vector<Index> checkpoints_up_to(Index limit, const RefineTuning& tuning) {
  std::vector<Index> list;
  for (const Index checkpoint : tuning.checkpoints)
    if (checkpoint < limit) list.push_back(checkpoint);
  list.push_back(limit);
  return list;
}

std::vector<LeftOutScores> scores_of(const std::vector<Fit>& fits) {
  std::vector<LeftOutScores> scores;
  for (const Fit& fit : fits) scores.push_back(fit.scores);
  return scores;
}

}  // namespace

CrossValidation::CrossValidation(const RefineInput& in)
    : in_(in), look_{in.options.densities_ahead()}, splits_(split_data(in)) {
  std::vector<double> samples;
  for (const SplitData& split : splits_)
    for (const Trajectory& run : split.runs.left_out.runs) samples.push_back(static_cast<double>(run.transitions()));
  samples_ = Eigen::Map<const Eigen::VectorXd>(samples.data(), std::ssize(samples));
}

void CrossValidation::consider(const std::vector<RefineStart>& candidates) {
  WorkCounter counter("fits of modes", candidates.size());
  for (const RefineStart& start : candidates) {
    fits_.push_back(possible() ? best_iterations(start) : Fit{start, start.model});
    if (!possible()) fits_.back().iterations = in_.options.max_iterations;
    fits_.back().row = fits_.size() - 1;
    counter.add();
  }
  if (possible()) chosen_ = fewest_modes_as_good(scores_of(fits_), samples_, refine_tuning);
}

Fit CrossValidation::best_iterations(const RefineStart& start) const {
  const Index modes = start.model.modes();
  SplitFits fits(in_, splits_, start);
  Fit best{start, start.model};
  best.scores.modes = modes;
  int falls = 0;
  for (const Index checkpoint : checkpoints_up_to(in_.options.max_iterations, refine_tuning)) {
    fits.advance_to(checkpoint);
    std::vector<Bank> banks = fits.banks();
    const LeftOutScores scores{modes, run_scores(banks, look_)};
    const double gain = mean_score(scores) - mean_score(best.scores);
    falls = gain < -refine_tuning.least_gain ? falls + 1 : 0;
    if (best.iterations == 0 || gain > 0.0) {
      best.iterations = checkpoint;
      best.scores = scores;
      best.of_splits = std::move(banks);
    }
    if (falls == refine_tuning.falls) break;
    if (fits.converged()) break;
  }
  return best;
}

std::vector<RefineCandidate> CrossValidation::table(std::size_t selected) const {
  const std::size_t best = possible() ? best_candidate(scores_of(fits_)) : 0;
  std::vector<RefineCandidate> rows;
  for (const Fit& fit : fits_) {
    RefineCandidate row{fit.start.name, fit.start.model.modes(), fit.start.noise_transitions, fit.iterations};
    row.theta_transitions = fit.start.theta_transitions;
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

Eigen::VectorXd CrossValidation::run_scores(const std::vector<Bank>& banks, const LookAhead& look) const {
  std::vector<const Bank*> bank_of;
  std::vector<const Trajectory*> runs;
  for (std::size_t s = 0; s < splits_.size(); ++s)
    for (const Trajectory& run : splits_[s].runs.left_out.runs) {
      bank_of.push_back(&banks[s]);
      runs.push_back(&run);
    }
  Eigen::VectorXd scores(std::ssize(runs));
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    scores(static_cast<Eigen::Index>(i)) = look_ahead_score(*bank_of[i], *runs[i], in_.filter, look);
  });
  return scores;
}

double CrossValidation::mean_score(const LeftOutScores& scores) const {
  const double sum = scores.log_likelihood.sum();
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum / samples_.sum();
}

}  // namespace modebank
