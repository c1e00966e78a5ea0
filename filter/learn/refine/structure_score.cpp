#include "filter/learn/refine/structure_score.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>
#include <optional>

#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

struct ModesAndStart {
  Index modes, start;
};
constexpr std::array<ModesAndStart, 6> asked_fits{{{1, 0}, {2, 0}, {2, 1}, {4, 0}, {4, 1}, {8, 0}}};
constexpr Index fit_count = asked_fits.size();
constexpr Index most_parts = 4, most_trial_iterations = 40, most_compared_transitions = 10000;
constexpr Index shortest_start = 30, start_per_regressor = 3;
constexpr double trial_tolerance = 1e-4;  // nats per transition

/// Log-likelihoods of the left-out runs of a split by every fit with one structure, learned from the other runs: a row
/// per run, a column per fit. The last column has the runs' numbers of transitions. Empty if there are no transitions
/// to learn from.
MatrixXd ask(const ValidationSplit& split, const LinearStructure& structure, Index latest, bool one_theta,
             std::uint64_t seed) {
  const Index earlier = latest - structure.first_transition();
  const Recording training = from_common_start(split.training, earlier),
                  left_out = from_common_start(split.left_out, earlier);
  try {
    const TrainingTransitions learned = gather_training_transitions(training, structure),
                              asked = gather_training_transitions(left_out, structure);
    const SwitchingPrior prior =
        switching_prior(learned, fit_global(training, structure), {}, refine_tuning.Q_transitions);
    const Index length = std::max(shortest_start, start_per_regressor * structure.regressors());
    MatrixXd said(std::ssize(asked.runs), fit_count + 1);
    said.col(fit_count) = sum_by_run(asked, asked.usable);
    tbb::parallel_for(Index{0}, fit_count, [&](Index f) {
      const ModesAndStart& fit = asked_fits[static_cast<std::size_t>(f)];
      ExpectationMaximisation em(learned, prior, {one_theta, trial_tolerance},
                                 start_from_stretches(learned, prior, fit.modes, length, seed, fit.start));
      for (Index i = 0; i < most_trial_iterations && !em.converged(); ++i) em.step();
      said.col(f) = sum_by_run(asked, predictive_log_densities(asked, em.model()));
    });
    return said;
  } catch (const DataError&) {
    return {};
  }
}

/// The log-likelihoods of all runs by the best number of modes, and the numbers of transitions: two columns. NaN if a
/// split has no transitions to learn from.
MatrixXd best_of(const std::vector<MatrixXd>& splits) {
  MatrixXd all(0, fit_count + 1);
  for (const MatrixXd& said : splits) {
    if (said.size() == 0) return MatrixXd::Constant(1, 2, not_a_number);
    all.conservativeResize(all.rows() + said.rows(), Eigen::NoChange);
    all.bottomRows(said.rows()) = said;
  }
  std::vector<LeftOutScores> of_fits;
  for (Index f = 0; f < fit_count; ++f) of_fits.push_back({asked_fits[static_cast<std::size_t>(f)].modes, all.col(f)});
  return all(Eigen::all, std::array{static_cast<Index>(best_candidate(of_fits)), fit_count});
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
  std::vector<std::vector<MatrixXd>> said(structures.size(), std::vector<MatrixXd>(splits.size()));
  tbb::parallel_for(std::size_t{0}, structures.size() * splits.size(), [&](std::size_t i) {
    const std::size_t s = i / splits.size(), part = i % splits.size();
    said[s][part] = ask(splits[part], structures[s], latest, one_theta, seed);
  });
  std::vector<LeftOutScores> candidates;
  VectorXd transitions;
  for (std::size_t s = 0; s < structures.size(); ++s) {
    const MatrixXd best = best_of(said[s]);
    candidates.push_back({structures[s].parameters(), best.col(0)});
    if (!best.col(0).allFinite()) continue;
    transitions = best.col(1);
    result.scores[s] = best.col(0).sum() / transitions.sum();
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
