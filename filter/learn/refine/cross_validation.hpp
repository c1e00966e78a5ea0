#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Start of a fit, and its priors.
struct RefineStart {
  std::string name;
  SwitchingRegression model;
  double noise_transitions = 0.0;
  double logit_width = 0.0;  ///< with_logit_prior; 0 for constant T
};

/// Inputs of the refinement of a bank. Holds references to the inputs.
struct RefineInput {
  const Recording& recording;
  const WindowFits& fits;
  const Bank& frame;  ///< the parts of the bank that are not refined
  const TrainingTransitions& transitions;
  const RefineOptions& options;
  const FilterOptions& filter;

  SwitchingPrior prior(const RefineStart& start) const;
  SwitchingEmOptions em() const;
  /// The smallest R in refinement, n_y. It is negligible.
  Eigen::VectorXd least_R() const;
};

/// The model accepted so far, with all additions. Each refinement step takes a Fit and returns a Fit. A Fit also
/// contains the fit to the training part of every split of the cross-validation. The rule (left_out/rule.hpp) decides
/// by these fits.
struct Fit {
  RefineStart start;
  std::size_t row = 0;               ///< row of the start in the table
  Eigen::Index iterations = 0;       ///< number of iterations of expectation-maximisation that scores best on left-out
                                     ///< runs
  LeftOutScores scores = {};         ///< scores on the left-out runs
  std::vector<Bank> of_splits = {};  ///< the fit without the left-out runs of each split; empty if no run is left out

  // The fields below are set after expectation-maximisation on all training runs:
  Bank bank = {};
  SwitchingPrior prior = {};
  bool R_estimated = false;
};

/// Expectation-maximisation on all training runs.
struct TrainingFit {
  SwitchingRegression model;
  ModePosterior posterior;
  std::vector<ScreenedMode> screened;  ///< modes removed from the frame and from the fit
  std::vector<double> objective;       ///< penalised log-likelihood before each iteration, until modes are removed
};

/// Runs expectation-maximisation for a number of iterations, or fewer if the objective converges. Then removes starved,
/// unstable and duplicate modes one by one. A few more iterations follow each removal.
TrainingFit fit_training_runs(const RefineInput& in, const RefineStart& start, Eigen::Index iterations);

/// The data of one split for fits.
struct SplitData {
  ValidationSplit runs;
  Bank frame;                       ///< RefineInput::frame, with a noise factor of these training runs
  TrainingTransitions transitions;  ///< of runs.training
  GlobalModel global;               ///< global model of the split's training transitions

  /// The prior from the split's training runs.
  SwitchingPrior prior(const RefineInput& in, const RefineStart& start) const;
};

/// Scores of training runs that were left out, for every start and number of iterations. For each start it stores the
/// fit after the best number of iterations. Holds references to its inputs.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries all candidates and adds a row for each to the table. Then chooses among all rows so far: the fewest modes
  /// that are as good as the best (fewest_modes_as_good). If no run can be left out, the first candidate is chosen and
  /// run to convergence.
  void consider(const std::vector<RefineStart>& candidates);
  /// The fits of every split from one start, after the number of iterations that scores best.
  Fit best_iterations(const RefineStart& start) const;

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
  LeftOutScores scores(const std::vector<Bank>& banks) const;
  /// Mean over all samples [nats]; minus infinity if a score is NaN.
  double mean_score(const LeftOutScores& scores) const;

 private:
  RefineInput in_;
  std::vector<SplitData> splits_;
  Eigen::VectorXd samples_;  ///< number of samples of each left-out run
  std::vector<Fit> fits_;
  std::size_t chosen_ = 0;
};

}  // namespace modebank
