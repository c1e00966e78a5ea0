#include "filter/learn/refine/cross_validation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "filter/learn/switching/starts.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/global_model.hpp"

namespace modebank {
namespace {

/// Standard error of a sum of what independent runs contribute.
double standard_error_of_sum(const Eigen::VectorXd& parts) {
  const auto n = static_cast<double>(parts.size());
  return n < 2.0 ? 0.0 : std::sqrt((parts.array() - parts.mean()).square().sum() * n / (n - 1.0));
}

/// Of ways that are as good as the best within one standard error of the difference over the runs left out (Breiman et
/// al. 1984, section 3.4.3) the one that is soonest ready to leave its start: new runs differ more from all training
/// runs than these do from each other. scores: of each way, one per run.
std::size_t soonest_of_the_good(const std::vector<NoiseAdaptation>& ways, const std::vector<Eigen::VectorXd>& scores) {
  const auto lower = [](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return a.sum() < b.sum(); };
  const std::size_t best = std::max_element(scores.begin(), scores.end(), lower) - scores.begin();
  std::size_t chosen = best;
  for (std::size_t w = 0; w < ways.size(); ++w) {
    const Eigen::VectorXd loss = scores[best] - scores[w];
    if (!(loss.sum() <= standard_error_of_sum(loss))) continue;
    const double sooner = ways[chosen].prior_samples - ways[w].prior_samples;
    if (sooner > 0.0 || (sooner == 0.0 && lower(scores[chosen], scores[w]))) chosen = w;
  }
  return chosen;
}

std::vector<Index> checkpoints_up_to(Index limit, const RefineTuning& tuning) {
  std::vector<Index> list;
  for (const Index checkpoint : tuning.checkpoints)
    if (checkpoint < limit) list.push_back(checkpoint);
  list.push_back(limit);
  return list;
}

/// The banks of one start on one split, at each checkpoint up to the limit. The prior is that of the split.
std::vector<Bank> fit_split(const RefineInput& in, const RefineStart& start, const Recording& training) {
  const TrainingTransitions transitions = gather_training_transitions(training, in.frame.structure);
  const SwitchingPrior prior = switching_prior(transitions, fit_global(training, transitions.structure),
                                               in.fits.prior_sd, start.noise_transitions, in.options.tuning);
  ExpectationMaximisation em(transitions, prior, em_options(in.options), start.model);
  std::vector<Bank> banks;
  Index done = 0;
  for (const Index checkpoint : checkpoints_up_to(in.options.max_iterations, in.options.tuning)) {
    for (; done < checkpoint; ++done) em.step();
    banks.push_back(with_modes(in.frame, em.model()));
  }
  return banks;
}

std::vector<Bank> at_checkpoint(const std::vector<std::vector<Bank>>& by_split, std::size_t checkpoint) {
  std::vector<Bank> banks;
  for (const std::vector<Bank>& of_split : by_split) banks.push_back(of_split[checkpoint]);
  return banks;
}

}  // namespace

CrossValidation::CrossValidation(const RefineInput& in)
    : in_(in), splits_(validation_splits(in.recording, in.options.folds, in.options.tuning)) {
  for (const ValidationSplit& split : splits_) samples_ += split.left_out.transitions(Role::train);
}

void CrossValidation::consider(const std::vector<RefineStart>& candidates) {
  std::vector<std::vector<Bank>> banks(candidates.size() * splits_.size());
  tbb::parallel_for(std::size_t{0}, banks.size(), [&](std::size_t i) {
    banks[i] = fit_split(in_, candidates[i / splits_.size()], splits_[i % splits_.size()].training);
  });
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto first = banks.begin() + static_cast<std::ptrdiff_t>(i * splits_.size());
    add(candidates[i], {first, first + static_cast<std::ptrdiff_t>(splits_.size())});
  }
}

std::vector<RefineCandidate> CrossValidation::table() const {
  std::vector<RefineCandidate> rows = table_;
  rows[selected_].selected = true;
  return rows;
}

std::vector<ScoredFit> CrossValidation::best_of_starts() const {
  std::vector<ScoredFit> fits;
  const auto same_start = [](const RefineStart& a, const RefineStart& b) {
    return a.name == b.name && a.model.modes() == b.model.modes();
  };
  for (const ScoredFit& fit : fits_of_rows_) {
    const auto known =
        std::find_if(fits.begin(), fits.end(), [&](const ScoredFit& f) { return same_start(f.start, fit.start); });
    if (known == fits.end())
      fits.push_back(fit);
    else if (table_[fit.row].score > table_[known->row].score)
      *known = fit;
  }
  std::sort(fits.begin(), fits.end(), [&](const ScoredFit& a, const ScoredFit& b) {
    const double better = table_[a.row].score - table_[b.row].score;
    return better > 0.0 || (!(better < 0.0) && a.row < b.row);
  });
  return fits;
}

NoiseAdaptation CrossValidation::adaptation(const std::vector<Bank>& of_splits) const {
  if (splits_.empty() || in_.filter.noise != FilterNoise::adaptive) return {};
  std::vector<NoiseAdaptation> ways;
  for (const double forgetting : in_.options.tuning.forgettings)
    for (const double prior : in_.options.tuning.noise_prior_samples) ways.push_back({forgetting, prior});
  std::vector<Eigen::VectorXd> scores(ways.size());
  tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t w) {
    std::vector<Bank> banks = of_splits;
    for (Bank& bank : banks) bank.noise_adaptation = ways[w];
    scores[w] = run_scores(banks);
  });
  return ways[soonest_of_the_good(ways, scores)];
}

Eigen::VectorXd CrossValidation::run_scores(const std::vector<Bank>& banks) const {
  std::vector<const Bank*> bank_of;
  std::vector<const Trajectory*> runs;
  for (std::size_t s = 0; s < splits_.size(); ++s)
    for (const Trajectory& run : splits_[s].left_out.runs) {
      bank_of.push_back(&banks[s]);
      runs.push_back(&run);
    }
  Eigen::VectorXd scores(std::ssize(runs));
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    scores(static_cast<Eigen::Index>(i)) = log_likelihood(*bank_of[i], *runs[i], in_.filter);
  });
  return scores;
}

double CrossValidation::score(const std::vector<Bank>& banks) const {
  const double sum = run_scores(banks).sum();
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum / static_cast<double>(samples_);
}

void CrossValidation::add(const RefineStart& candidate, const std::vector<std::vector<Bank>>& by_split) {
  RefineCandidate row{candidate.name, candidate.model.modes(), candidate.noise_transitions, in_.options.max_iterations,
                      not_a_number};
  std::size_t checkpoint = 0;
  if (!splits_.empty()) {
    std::vector<double> scores(by_split.front().size());
    tbb::parallel_for(std::size_t{0}, scores.size(),
                      [&](std::size_t c) { scores[c] = score(at_checkpoint(by_split, c)); });
    checkpoint = std::max_element(scores.begin(), scores.end()) - scores.begin();
    row.iterations = checkpoints_up_to(in_.options.max_iterations, in_.options.tuning)[checkpoint];
    row.score = scores[checkpoint];
  }
  table_.push_back(row);
  if (!splits_.empty()) fits_of_rows_.push_back({candidate, table_.size() - 1, at_checkpoint(by_split, checkpoint)});
  if (table_.size() > 1 && !(row.score > table_[selected_].score)) return;
  selected_ = table_.size() - 1;
  best_ = candidate;
  if (!splits_.empty()) best_banks_ = at_checkpoint(by_split, checkpoint);
}

}  // namespace modebank
