#pragma once

#include <vector>

#include "filter/learn/refine/folds.hpp"
#include "filter/learn/refine/refine.hpp"
#include "filter/learn/refine/training_fit.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// One start's fit, how it scored, and what it was on each split.
struct ScoredFit {
  RefineStart start;
  std::size_t row = 0;  ///< in the table
  std::vector<Bank> banks;
};

/// Scores of training runs left out, for every start, number of iterations and way to adapt. Keeps the input's
/// references.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries all and remembers the best of these and earlier ones; adds a row for each to the table. Without anything to
  /// leave out the first one is the best, run to convergence.
  void consider(const std::vector<RefineStart>& candidates);

  /// Whether there is anything to leave out.
  bool possible() const { return !splits_.empty(); }
  const std::vector<ValidationSplit>& splits() const { return splits_; }
  const RefineStart& best() const { return best_; }
  const std::vector<Bank>& best_banks() const { return best_banks_; }  ///< the best fit on every split
  Index iterations() const { return table_[selected_].iterations; }
  std::vector<RefineCandidate> table() const;

  /// The best fit from every start, the best first: it is best()'s.
  std::vector<ScoredFit> best_of_starts() const;

  /// Mean log score of the runs left out, nats per sample; `banks`: one per split. Minus infinity where there is none.
  double score(const std::vector<Bank>& banks) const;

  /// How the noise scale should move in the filter of these banks, one per split: of ways that the runs left out do not
  /// tell apart, the one that soonest leaves its start.
  NoiseAdaptation adaptation(const std::vector<Bank>& of_splits) const;

 private:
  /// Log-likelihood of each run left out.
  Eigen::VectorXd run_scores(const std::vector<Bank>& banks) const;
  void add(const RefineStart& candidate, const std::vector<std::vector<Bank>>& by_split);

  RefineInput in_;
  std::vector<ValidationSplit> splits_;
  Index samples_ = 0;
  std::vector<RefineCandidate> table_;
  std::size_t selected_ = 0;
  RefineStart best_;
  std::vector<Bank> best_banks_;
  std::vector<ScoredFit> fits_of_rows_;
};

}  // namespace modebank
