#include "filter/learn/refine/structure_score.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/refine/learning_part.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct ModesAndStart {
  Index modes, start;
};
constexpr std::array<ModesAndStart, 6> asked_fits{{{1, 0}, {2, 0}, {2, 1}, {4, 0}, {4, 1}, {8, 0}}};
constexpr Index most_parts = 4, most_trial_iterations = 40, most_compared_transitions = 10000;
constexpr Index shortest_start = 30, start_per_regressor = 3;
constexpr double trial_tolerance = 1e-4;  // nats per transition

/// Log-likelihoods of left-out runs, and their numbers of transitions.
struct LeftOutRuns {
  VectorXd log_likelihood, transitions;
};

/// Predicts the left-out runs by one fit that was learned from the other runs.
LeftOutRuns predict(const TrainingTransitions& learned, const TrainingTransitions& left_out,
                    const SwitchingPrior& prior, const ModesAndStart& fit, bool one_theta, std::uint64_t seed) {
  const Index length = std::max(shortest_start, start_per_regressor * learned.structure.regressors());
  ExpectationMaximisation em(learned, prior, {one_theta, trial_tolerance},
                             start_from_stretches(learned, prior, fit.modes, length, seed, fit.start));
  for (Index i = 0; i < most_trial_iterations && !em.converged(); ++i) em.step();
  return {sum_by_run(left_out, predictive_log_densities(left_out, em.model())), sum_by_run(left_out, left_out.usable)};
}

/// Predictions of the left-out runs of a split by every fit with one structure. Empty if there are no transitions to
/// learn from.
std::vector<LeftOutRuns> ask(const ValidationSplit& split, const LinearStructure& structure, Index latest,
                             bool one_theta, std::uint64_t seed) {
  const Index earlier = latest - structure.first_transition();
  const Recording training = from_common_start(split.training, earlier),
                  left_out = from_common_start(split.left_out, earlier);
  try {
    const TrainingTransitions learned = gather_training_transitions(training, structure),
                              asked = gather_training_transitions(left_out, structure);
    const SwitchingPrior prior =
        switching_prior(learned, fit_global(training, structure), {}, refine_tuning.Q_transitions, refine_tuning);
    std::vector<LeftOutRuns> said(asked_fits.size());
    tbb::parallel_for(std::size_t{0}, said.size(),
                      [&](std::size_t f) { said[f] = predict(learned, asked, prior, asked_fits[f], one_theta, seed); });
    return said;
  } catch (const DataError&) {
    return {};
  }
}

VectorXd joined(const std::vector<VectorXd>& parts) {
  Index size = 0, at = 0;
  for (const VectorXd& part : parts) size += part.size();
  VectorXd all(size);
  for (const VectorXd& part : parts) {
    all.segment(at, part.size()) = part;
    at += part.size();
  }
  return all;
}

/// The best number of modes of a structure, with the log-likelihoods of all runs. NaN if a split has no transitions to
/// learn from.
LeftOutRuns best_of(const std::vector<std::vector<LeftOutRuns>>& splits) {
  LeftOutRuns best{VectorXd::Constant(1, not_a_number), VectorXd::Ones(1)};
  if (std::any_of(splits.begin(), splits.end(), [](const auto& said) { return said.empty(); })) return best;
  for (std::size_t f = 0; f < asked_fits.size(); ++f) {
    std::vector<VectorXd> likelihoods, transitions;
    for (const std::vector<LeftOutRuns>& said : splits) {
      likelihoods.push_back(said[f].log_likelihood);
      transitions.push_back(said[f].transitions);
    }
    LeftOutRuns all{joined(likelihoods), joined(transitions)};
    if (!(all.log_likelihood.sum() <= best.log_likelihood.sum())) best = std::move(all);
  }
  return best;
}

}  // namespace

StructuresOfModes compare_structures(const Recording& all, const std::vector<LinearStructure>& structures,
                                     std::size_t incumbent, bool one_theta, std::uint64_t seed) {
  const std::optional<Recording> fewer = learning_part(all, most_compared_transitions, seed);
  const std::vector<ValidationSplit> splits = validation_splits(fewer ? *fewer : all, most_parts);
  StructuresOfModes result{std::vector<double>(structures.size(), -std::numeric_limits<double>::infinity()), incumbent};
  if (splits.empty()) return result;
  Index latest = 0;
  for (const LinearStructure& s : structures) latest = std::max(latest, s.first_transition());
  std::vector<std::vector<std::vector<LeftOutRuns>>> said(structures.size(),
                                                          std::vector<std::vector<LeftOutRuns>>(splits.size()));
  tbb::parallel_for(std::size_t{0}, structures.size() * splits.size(), [&](std::size_t i) {
    const std::size_t s = i / splits.size(), part = i % splits.size();
    said[s][part] = ask(splits[part], structures[s], latest, one_theta, seed);
  });
  std::vector<LeftOutScores> candidates;
  VectorXd transitions;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const LeftOutRuns best = best_of(said[s]);
    candidates.push_back({structures[s].parameters(), best.log_likelihood});
    if (!best.log_likelihood.allFinite()) continue;
    transitions = best.transitions;
    result.scores[s] = best.log_likelihood.sum() / transitions.sum();
  }
  if (transitions.size() == 0) return result;
  const LeftOutScores& best = candidates[best_candidate(candidates)];
  const PairedLoss loss = paired_loss(best.log_likelihood, candidates[incumbent].log_likelihood, transitions);
  const bool fewer_lags = best.modes < candidates[incumbent].modes;
  if (loss.mean >= least_structure_gain && (fewer_lags || loss.mean >= loss.standard_error))
    result.chosen = fewest_modes_as_good(candidates, transitions, {});
  return result;
}

}  // namespace modebank
