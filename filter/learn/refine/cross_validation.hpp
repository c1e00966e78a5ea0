#pragma once

#include <cstddef>
#include <vector>

#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/refine/fit.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/refine/split_fits.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// Scores of training runs that were left out, for every start and number of iterations. For each start it stores the
/// fit after the best number of iterations. Holds references to its inputs.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries all candidates and adds a row for each to the table. Then chooses among all rows so far: the fewest modes
  /// that are as good as the best (fewest_modes_as_good). If no run can be left out, the first candidate is chosen and
  /// run to convergence.
  void consider(const std::vector<RefineStart>& candidates);

  /// Whether any run can be left out.
  bool possible() const { return !splits_.empty(); }
  const std::vector<SplitData>& splits() const { return splits_; }
  const Fit& chosen() const { return fits_[chosen_]; }
  /// Number of samples of each left-out run.
  const Eigen::VectorXd& samples() const { return samples_; }
  /// One row per start; the row of `selected` is marked.
  std::vector<RefineCandidate> table(std::size_t selected) const;

  /// The best fit of every start, in decreasing order of score.
  std::vector<Fit> best_of_starts() const;

  /// Log-likelihoods of the left-out runs; `banks`: one per split.
  LeftOutScores scores(const std::vector<Bank>& banks) const { return scores(banks, look_); }
  /// Scores with other look-ahead settings.
  LeftOutScores scores(const std::vector<Bank>& banks, const LookAhead& look) const {
    return {banks.front().mode_count(), run_scores(banks, look)};
  }
  /// Mean over all samples [nats]; minus infinity if a score is NaN.
  double mean_score(const LeftOutScores& scores) const;

 private:
  /// Score of each left-out run.
  Eigen::VectorXd run_scores(const std::vector<Bank>& banks, const LookAhead& look) const;
  Fit best_iterations(const RefineStart& start) const;

  RefineInput in_;
  LookAhead look_;  ///< horizon of the densities
  std::vector<SplitData> splits_;
  Eigen::VectorXd samples_;  ///< number of samples of each left-out run
  std::vector<Fit> fits_;
  std::size_t chosen_ = 0;
};

}  // namespace modebank
