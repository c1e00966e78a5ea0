#include "filter/learn/refine/cross_validation.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/step/motions.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

/// Left-out runs are scored after these numbers of iterations, and at the iteration limit. The start has used all
/// training runs, so a fit must first forget the left-out ones. Earlier checkpoints made results on ICE worse.
constexpr std::array<Index, 7> checkpoints{10, 20, 35, 60, 100, 200, 1000};
/// A start is dropped if its score is at least least_gain below its best score for this number of checkpoints in a
/// row. On ICE, FLOORING and DRIVE (training runs; 13, 13 and 10 starts) no start recovered after two checkpoints,
/// but some recovered after one.
constexpr int most_falls = 2;
constexpr Index iterations_after_screening = 10;  // in which the other modes adapt; equal to the first checkpoint

constexpr std::array trial_modes{1, 2, 2, 4, 4, 8}, trial_starts{0, 0, 1, 0, 1, 0};
constexpr Index trial_count = trial_modes.size();
constexpr Index most_parts = 4, most_trial_iterations = 40, most_compared_transitions = 10000;
constexpr Index shortest_start = 30, start_per_regressor = 3;
constexpr double trial_tolerance = 1e-4;  // nats per transition

/// Log-likelihoods of the left-out runs of a split by every trial with one structure, learned from the other runs: a
/// row per run, a column per trial. The last column has the runs' numbers of transitions. NaN if there are no
/// transitions to learn from. `latest`: first transition that every structure predicts.
Eigen::MatrixXd ask(const ValidationSplit& split, const LinearStructure& structure, Index latest, bool one_theta,
                    std::uint64_t seed) {
  const Index earlier = latest - structure.first_transition();
  Eigen::MatrixXd said = Eigen::MatrixXd::Constant(std::ssize(split.left_out.runs), trial_count + 1, not_a_number);
  try {
    const Recording training = from_common_start(split.training, earlier);
    const TrainingTransitions learned = gather_training_transitions(training, structure);
    const auto asked = gather_training_transitions(from_common_start(split.left_out, earlier), structure);
    const SwitchingPrior prior = switching_prior(learned, fit_global(training, structure), {}, usual_Q_transitions);
    const Index length = std::max(shortest_start, start_per_regressor * structure.regressors());
    said.col(trial_count) = sum_by_run(asked, asked.usable);
    tbb::parallel_for(Index{0}, trial_count, [&](Index t) {
      SwitchingFit fit{start_from_stretches(learned, prior, trial_modes[t], length, seed, trial_starts[t])};
      if (one_theta) fit.model.motion.assign(static_cast<std::size_t>(trial_modes[t]), 0);
      iterate(learned, prior, {trial_tolerance}, most_trial_iterations, fit);
      said.col(t) = sum_by_run(asked, predictive_log_densities(asked, fit.model));
    });
  } catch (const DataError&) {
  }
  return said;
}

}  // namespace

SwitchingFit fit_training_runs(const RefineInput& in, const BankCandidate& candidate) {
  const TrainingTransitions& transitions = in.all.transitions;
  const SwitchingPrior prior = in.prior(in.all, candidate.logit_width);
  SwitchingFit fit{candidate.start};
  iterate(transitions, prior, in.em(), candidate.iterations, fit);
  fit.screened = in.frame.screened;
  while (in.options.screen) {
    const auto dropped = drop_worst_mode(transitions, fit.posterior, fit.model);
    if (!dropped) break;
    fit.screened.push_back(*dropped);
    SwitchingFit rest{std::move(fit.model)};
    iterate(transitions, prior, in.em(), iterations_after_screening, rest);
    fit.model = std::move(rest.model);
    fit.posterior = std::move(rest.posterior);
  }
  return fit;
}

CrossValidation::CrossValidation(const RefineInput& in)
    : in_(in), splits_(validation_splits(in.all.recording, in.options.folds)) {
  std::vector<double> samples;
  for (const ValidationSplit& split : splits_) {
    for (const Trajectory& run : split.left_out.runs) samples.push_back(static_cast<double>(run.transitions()));
    const Bank& frame = in.frame;
    try {
      if (frame.R.isZero(0.0)) left_out_.push_back(gather_training_transitions(split.left_out, frame.structure));
    } catch (const DataError&) {  // no complete transition
    }
    learning_.push_back({split.training, gather_training_transitions(split.training, frame.structure),
                         fit_global(split.training, frame.structure)});
  }
  if (left_out_.size() < splits_.size()) left_out_.clear();
  samples_ = Eigen::VectorXd::Map(samples.data(), std::ssize(samples));
}

void CrossValidation::consider(const std::vector<BankCandidate>& candidates) {
  WorkCounter counter("fits of modes", candidates.size());
  for (BankCandidate candidate : candidates) {
    candidate.row = fits_.size();
    candidate.iterations = in_.options.max_iterations;
    fits_.push_back(possible() ? best_iterations(std::move(candidate)) : Fit{std::move(candidate)});
    scores_.push_back(fits_.back().scores);
    counter.add();
  }
  choose();
}

void CrossValidation::consider(const std::string& name, LearnedBank learned) {
  constexpr Index iterations_of_split = 20;  // enough to forget the left-out runs
  constexpr double share_of_R = 0.1;         // an R of all runs would tell of those left out
  Bank start = learned.bank;
  if (in_.estimates_R()) start.R.diagonal() = in_.single.R.cwiseMax(share_of_R * learned.bank.R.diagonal());
  Fit fit{{name, switching_model(learned.bank), 0.0, learned.iterations, fits_.size()}};
  fit.of_splits.resize(splits_.size());
  tbb::parallel_for(std::size_t{0}, splits_.size(), [&](std::size_t s) {
    fit.of_splits[s] = maximise_measured(in_, learning_[s], start, iterations_of_split).bank;
  });
  fit.learned = std::move(learned);
  fit.scores = scores(fit.of_splits);
  scores_.push_back(fit.scores);
  fits_.push_back(std::move(fit));
  choose();
}

void CrossValidation::choose() {
  if (possible()) chosen_ = fewest_motions_as_good(scores_, least_nats(samples_.sum(), in_.single.response_samples));
}

Fit CrossValidation::best_iterations(BankCandidate candidate) const {
  std::vector<SwitchingFit> fits(learning_.size(), SwitchingFit{candidate.start});
  std::vector<SwitchingPrior> priors;
  for (const LearningRuns& runs : learning_) priors.push_back(in_.prior(runs, candidate.logit_width));
  Fit best{std::move(candidate)};
  const Index limit = in_.options.max_iterations;
  Index done = 0;
  int falls = 0;
  bool converged = false;
  do {
    const auto next = std::upper_bound(checkpoints.begin(), checkpoints.end(), done);
    const Index checkpoint = next == checkpoints.end() ? limit : std::min(*next, limit);
    tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t s) {
      iterate(learning_[s].transitions, priors[s], in_.em(), checkpoint - done, fits[s]);
    });
    std::vector<Bank> banks;
    for (std::size_t s = 0; s < fits.size(); ++s) banks.push_back(with_modes(in_.frame, fits[s].model));
    LeftOutScores of_banks = left_out_.empty() ? scores(banks) : exact_scores(fits);
    const double gain = mean_score(of_banks) - mean_score(best.scores);
    falls = done > 0 && gain < -least_gain ? falls + 1 : 0;
    if (done == 0 || gain > 0.0) {
      best.candidate.iterations = checkpoint;
      best.scores = std::move(of_banks);
      best.of_splits = std::move(banks);
    }
    done = checkpoint;
    converged = std::all_of(fits.begin(), fits.end(), [](const auto& fit) { return fit.converged; });
  } while (done < limit && falls < most_falls && !converged);
  return best;
}

std::vector<RefineCandidate> CrossValidation::table(std::size_t selected) const {
  const std::size_t best = possible() ? best_candidate(scores_) : 0;
  std::vector<RefineCandidate> rows;
  for (const Fit& fit : fits_) {
    const BankCandidate& of = fit.candidate;
    rows.push_back({of.name, of.start.modes(), of.iterations});
    if (!possible()) continue;
    const PairedLoss loss = paired_loss(fits_[best].scores.log_likelihood, fit.scores.log_likelihood, samples_);
    rows.back().score = mean_score(fit.scores);
    rows.back().loss = loss.mean;
    rows.back().loss_standard_error = loss.standard_error;
  }
  rows[selected].selected = true;
  return rows;
}

std::vector<Fit> CrossValidation::best_of_starts() const {
  std::vector<Fit> fits = fits_, best;
  std::stable_sort(fits.begin(), fits.end(),
                   [&](const Fit& a, const Fit& b) { return mean_score(a.scores) > mean_score(b.scores); });
  for (const Fit& fit : fits)
    if (std::none_of(best.begin(), best.end(), [&](const Fit& better) {
          return better.candidate.name == fit.candidate.name && better.scores.modes == fit.scores.modes;
        }))
      best.push_back(fit);
  return best;
}

LeftOutScores CrossValidation::exact_scores(const std::vector<SwitchingFit>& fits) const {
  const SwitchingRegression& model = fits.front().model;
  LeftOutScores result{model.modes(), Eigen::VectorXd(samples_.size()),
                       model.motion.empty() ? model.modes() : model.motion.back() + 1};
  std::vector<Index> first{0};  // left-out run of every split
  for (const TrainingTransitions& rows : left_out_) first.push_back(first.back() + std::ssize(rows.runs));
  tbb::parallel_for(std::size_t{0}, fits.size(), [&](std::size_t s) {
    result.log_likelihood.segment(first[s], first[s + 1] - first[s]) =
        sum_by_run(left_out_[s], predictive_log_densities(left_out_[s], fits[s].model));
  });
  return result;
}

LeftOutScores CrossValidation::scores(const std::vector<Bank>& banks) const {
  std::vector<std::pair<const Bank*, const Trajectory*>> runs;
  for (std::size_t s = 0; s < splits_.size(); ++s)
    for (const Trajectory& run : splits_[s].left_out.runs) runs.emplace_back(&banks[s], &run);
  LeftOutScores result{banks.front().mode_count(), Eigen::VectorXd(std::ssize(runs)), motion_count(banks.front())};
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    result.log_likelihood(static_cast<Index>(i)) = log_likelihood(*runs[i].first, *runs[i].second, in_.filter);
  });
  return result;
}

double CrossValidation::mean_score(const LeftOutScores& scores) const {
  const double sum = scores.log_likelihood.sum();
  return std::isnan(sum) ? -std::numeric_limits<double>::infinity() : sum / samples_.sum();
}

StructuresOfModes compare_structures(const Recording& all, const std::vector<LinearStructure>& structures,
                                     std::size_t incumbent, bool one_theta, std::uint64_t seed) {
  const std::optional<Recording> fewer = learning_part(all, most_compared_transitions, seed);
  std::vector<ValidationSplit> splits = validation_splits(fewer ? *fewer : all, most_parts);
  StructuresOfModes result{std::vector<double>(structures.size(), -std::numeric_limits<double>::infinity()), incumbent};
  Index latest = 0;
  for (const LinearStructure& s : structures) latest = std::max(latest, s.first_transition());
  std::vector<Index> rows{0};  // of the left-out runs of the splits before each
  for (ValidationSplit& split : splits) {
    for (Recording* part : {&split.training, &split.left_out})  // runs too short for one structure are left to none
      std::erase_if(part->runs, [&](const Trajectory& run) { return run.samples() <= latest + 2; });
    rows.push_back(rows.back() + std::ssize(split.left_out.runs));
  }
  if (rows.back() == 0) return result;
  std::vector<Eigen::MatrixXd> said(structures.size(), Eigen::MatrixXd(rows.back(), trial_count + 1));
  tbb::parallel_for(std::size_t{0}, structures.size() * splits.size(), [&](std::size_t i) {
    const std::size_t s = i / splits.size(), part = i % splits.size();
    said[s].middleRows(rows[part], rows[part + 1] - rows[part]) =
        ask(splits[part], structures[s], latest, one_theta, seed);
  });
  std::vector<LeftOutScores> candidates;
  Eigen::VectorXd transitions;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    std::vector<LeftOutScores> of_trials;
    for (Index t = 0; t < trial_count; ++t) of_trials.push_back({trial_modes[t], said[s].col(t)});
    candidates.push_back({structures[s].parameters(), of_trials[best_candidate(of_trials)].log_likelihood});
    if (!candidates.back().log_likelihood.allFinite()) continue;
    transitions = said[s].col(trial_count);
    result.scores[s] = candidates.back().log_likelihood.sum() / transitions.sum();
  }
  if (transitions.size() == 0) return result;
  const LeftOutScores& best = candidates[best_candidate(candidates)];
  const PairedLoss loss = paired_loss(best.log_likelihood, candidates[incumbent].log_likelihood, transitions);
  const bool fewer_lags = best.modes < candidates[incumbent].modes;
  if (loss.mean >= least_structure_gain && (fewer_lags || loss.mean >= loss.standard_error))
    result.chosen = fewest_motions_as_good(candidates, transitions.sum() * least_worth(transitions.sum()));
  return result;
}

}  // namespace modebank
