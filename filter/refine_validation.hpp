#pragma once

#include <string>
#include <vector>

#include "filter/bank.hpp"
#include "filter/evaluate.hpp"
#include "filter/likelihood_ascent.hpp"
#include "filter/refine.hpp"
#include "filter/switching_regression.hpp"
#include "filter/validation_split.hpp"
#include "ident/local_model.hpp"

namespace modebank {

/// What is refined from where.
struct RefineStart {
  std::string name;
  SwitchingRegression model;
  SharedParts shared = SharedParts::none;
  double noise_transitions = 0.0;
};

/// One start's fit, how it scored, and what it was on each split.
struct ScoredFit {
  RefineStart start;
  std::size_t row = 0;  ///< in the table
  std::vector<Bank> banks;
};

/// Scores of training runs left out, for every start, number of iterations and way to adapt. Keeps references to
/// windows and frame.
class CrossValidation {
 public:
  CrossValidation(const Recording& recording, const WindowFits& fits, const Bank& frame, const RefineOptions& options,
                  const FilterOptions& filter);

  /// Tries all and remembers the best of these and earlier ones; adds a row for each to the table. Without anything to
  /// leave out the first one is the best, run to convergence.
  void consider(const std::vector<RefineStart>& candidates);

  /// Whether there is anything to leave out.
  bool possible() const { return !splits_.empty(); }
  const RefineStart& best() const { return best_; }
  Index iterations() const { return table_[selected_].iterations; }
  std::vector<RefineCandidate> table() const;

  /// The best fit from every start, the best first: it is best()'s.
  std::vector<ScoredFit> best_of_starts() const;

  /// Mean log score of the runs left out, nats per sample; `banks`: one per split. Minus infinity where there is none.
  double score(const std::vector<Bank>& banks) const;

  /// How the noise scale should move in the best one's filter, or in that of other banks, one per split: of ways that
  /// the runs left out do not tell apart, the one that soonest leaves its start.
  NoiseAdaptation adaptation() const { return adaptation(best_banks_); }
  NoiseAdaptation adaptation(const std::vector<Bank>& of_splits) const;

  /// Score of the best one with R, every Q multiplied by `process_factor`, and this adaptation.
  double score_with_R(const Eigen::MatrixXd& R, double process_factor, const NoiseAdaptation& adaptation) const;
  /// Score when every split's training runs fit on with the states unknown (refine_measured.hpp) from `fitted`, the fit
  /// to all of them: a maximum nearby is soon reached and does not remember where the way to it began.
  double score_with_states_unknown(const LikelihoodTarget& target, const Bank& fitted) const;

 private:
  /// Log-likelihood of each run left out.
  Eigen::VectorXd run_scores(const std::vector<Bank>& banks) const;
  void add(const RefineStart& candidate, const std::vector<std::vector<Bank>>& by_split);

  std::vector<ValidationSplit> splits_;
  const WindowFits& fits_;
  const Bank& frame_;
  RefineOptions options_;
  FilterOptions filter_;
  Index samples_ = 0;
  std::vector<RefineCandidate> table_;
  std::size_t selected_ = 0;
  RefineStart best_;
  std::vector<Bank> best_banks_;
  std::vector<ScoredFit> fits_of_rows_;
};

/// The least R that refinement knows: as good as none.
Eigen::VectorXd least_measurement_noise(const WindowFits& fits);

}  // namespace modebank
