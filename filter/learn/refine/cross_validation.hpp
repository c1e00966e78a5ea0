#pragma once

#include <cstddef>
#include <vector>

#include "filter/judge/run/look_ahead.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Scores of training runs left out, for every start, number of iterations and way to adapt: of each start the fit
/// after the number of iterations that scored best. Keeps the input's references.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries all, adds a row for each to the table and chooses among these and earlier ones: the fewest modes that are as
  /// good as the best (fewest_modes_as_good). Without anything to leave out the first one is chosen, run to
  /// convergence.
  void consider(const std::vector<RefineStart>& candidates);

  /// Whether there is anything to leave out.
  bool possible() const { return !splits_.empty(); }
  const std::vector<SplitData>& splits() const { return splits_; }
  const Fit& chosen() const { return fits_[chosen_]; }
  /// Of each run left out.
  const Eigen::VectorXd& samples() const { return samples_; }
  /// A row of each start; that of `selected` is marked.
  std::vector<RefineCandidate> table(std::size_t selected) const;

  /// The best fit from every start, the best first.
  std::vector<Fit> best_of_starts() const;
  /// The best fit of every number of modes, the best first.
  std::vector<Fit> best_of_each_size() const;

  /// Log-likelihoods of the runs left out; `banks`: one per split.
  LeftOutScores scores(const std::vector<Bank>& banks) const { return scores(banks, look_); }
  /// The same of what is counted by learning that looks ahead so.
  LeftOutScores scores(const std::vector<Bank>& banks, const LookAhead& look) const {
    return {banks.front().mode_count(), run_scores(banks, look)};
  }
  /// Mean over all samples [nats]; minus infinity where a score is NaN.
  double mean_score(const LeftOutScores& scores) const;

  /// How the noise scale should move in the filter of these banks, one per split: of ways that the runs left out do not
  /// tell apart, the one that soonest leaves its start.
  NoiseAdaptation adaptation(const std::vector<Bank>& of_splits) const;

 private:
  /// Of each run left out.
  Eigen::VectorXd run_scores(const std::vector<Bank>& banks, const LookAhead& look) const;
  Fit best_iterations(const RefineStart& start) const;

  RefineInput in_;
  LookAhead look_;  ///< at which densities
  std::vector<SplitData> splits_;
  Eigen::VectorXd samples_;  ///< of each run left out
  std::vector<Fit> fits_;
  std::size_t chosen_ = 0;
};

}  // namespace modebank
