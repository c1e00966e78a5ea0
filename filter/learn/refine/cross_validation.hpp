#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/left_out/rule.hpp"
#include "filter/learn/switching/regression.hpp"
#include "modebank/filter/options.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// Start of a fit, and its number of iterations.
struct BankCandidate {
  std::string name;
  SwitchingRegression start;
  double logit_width = 0.0;  ///< 0 for constant T
  Index iterations = 0;
  std::size_t row = 0;  ///< row in the table
};

/// Runs to learn from: all training runs, or those that a split leaves.
struct LearningRuns {
  const Recording& recording;
  TrainingTransitions transitions;
  GlobalModel global;
};

/// What modes take from one linear motion with measurement noise.
struct SingleModel {
  Eigen::VectorXd R;              ///< n_y
  double response_samples = 1.0;  ///< step/motions.hpp
};

/// Inputs of the refinement of a bank.
struct RefineInput {
  const WindowFits& fits;
  const RefineOptions& options;
  const FilterOptions& filter;
  LearningRuns all;
  Bank frame;  ///< the parts of the bank that are not refined
  SingleModel single = {};
  double Q_transitions = usual_Q_transitions;  ///< of the prior
  bool unknown_states = false;                 ///< whether measurement noise is not small beside Q

  SwitchingPrior prior(const LearningRuns& runs, double logit_width = 0.0) const {
    return switching_prior(runs.transitions, runs.global, fits.prior_sd, Q_transitions, logit_width);
  }
  SwitchingEmOptions em() const { return {options.tolerance}; }
  bool estimates_R() const { return unknown_states && options.measurement_noise; }
  /// The smallest R in refinement, n_y: a negligible share of the global residual variance.
  Eigen::VectorXd least_R() const { return 1e-9 * fits.global.noise_variance(); }
};

/// A bank that was learned from some runs.
struct LearnedBank {
  Bank bank = {};
  SwitchingPrior prior = {};    ///< with which it is most likely
  double log_likelihood = 0.0;  ///< without the prior
  Index iterations = 0;
  MeasuredFit end = MeasuredFit::none;  ///< of the maximisation with unknown states; none: states are exact
};

/// The model accepted so far, and its fit to the training part of every split of the cross-validation.
struct Fit {
  BankCandidate candidate;  ///< with the number of iterations that scores best on left-out runs
  LeftOutScores scores = {};
  std::vector<Bank> of_splits = {};  ///< the fit without the left-out runs of each split; empty if no run is left out
  LearnedBank learned = {};          ///< from all training runs; of exact states at the end

  bool exact() const { return learned.end == MeasuredFit::none; }
};

/// Makes the candidate's iterations on all training runs. Then removes unusable modes one by one, each followed by a
/// few iterations. `screened` has the frame's, too; `objective` ends before the first removal.
SwitchingFit fit_training_runs(const RefineInput& in, const BankCandidate& candidate);

/// Scores of training runs that were left out, for every candidate: the likelihood of their complete transitions by the
/// switching regression (Hamilton 1989), which is the filter's at R = 0, else the filter's.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries the candidates. Then chooses among all so far (fewest_motions_as_good); the first if no run can be left out.
  void consider(const std::vector<BankCandidate>& candidates);
  /// Tries a bank that was learned with unknown states: its likelihood is maximised further on each split. Some run
  /// must be left out.
  void consider(const std::string& name, LearnedBank learned);
  /// The fits of every split from one start, after the number of iterations that scores best.
  Fit best_iterations(BankCandidate candidate) const;

  bool possible() const { return !splits_.empty(); }  ///< whether any run can be left out
  const std::vector<ValidationSplit>& splits() const { return splits_; }
  const std::vector<LearningRuns>& learning() const { return learning_; }  ///< the data of each split for fits
  const Fit& last() const { return fits_.back(); }
  const Fit& chosen() const { return fits_[chosen_]; }
  const Eigen::VectorXd& samples() const { return samples_; }  ///< of each left-out run
  std::vector<RefineCandidate> table(std::size_t selected) const;

  /// The best fit of every start, in decreasing order of score.
  std::vector<Fit> best_of_starts() const;
  /// Log-likelihoods of the left-out runs by the filter; `banks`: one per split.
  LeftOutScores scores(const std::vector<Bank>& banks) const;
  /// Mean over all samples [nats]; minus infinity if a score is NaN.
  double mean_score(const LeftOutScores& scores) const;

 private:
  const RefineInput& in_;
  std::vector<ValidationSplit> splits_;
  std::vector<LearningRuns> learning_;
  std::vector<TrainingTransitions> left_out_;  ///< of each split; empty: the filter scores
  Eigen::VectorXd samples_;
  std::vector<Fit> fits_;
  std::vector<LeftOutScores> scores_;
  std::size_t chosen_ = 0;

  void choose();
  LeftOutScores exact_scores(const std::vector<SwitchingFit>& fits) const;
};

/// Decides whether transition probabilities depend on state and input, and how strongly. Every start's fit with
/// constant T continues as a logit on all training runs. The most likely is also tried with fewer modes, by merging one
/// pair after another: on one dead zone three modes that were fitted directly were 0.4 nats per sample worse than three
/// that came from merging six. Left-out runs choose the number of modes, then the width of the weights. Empty if
/// is_worth_it rejects the gain over constant T.
std::optional<Fit> choose_logit(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage);

/// The bank with the R of the single model, if R is estimated, and R taken out of Q.
Bank with_R_out_of_Q(const RefineInput& in, Bank bank);

/// The bank of these runs with unknown states, from `start`; after at most so many iterations.
LearnedBank maximise_measured(const RefineInput& in, const LearningRuns& runs, const Bank& start, Index iterations);

/// Tries up to `most` motions times 1, 2 and 4 noise levels, at most options.most_modes in all, until another motion
/// gains less than the limit on left-out runs. Starts: the likeliest modes from random stretches, each motion of a
/// smaller bank split in two (half or twice the response time, 1.5 times the gain or a part of it), each level split in
/// a quiet and a loud one. The likeliest after the maximisation stays. With exact states, then with unknown ones.
void consider_motions(const RefineInput& in, Index most, CrossValidation& validation);

/// Gives the closest motions of the chosen free chain one theta, as long as the bank with fewer motions is chosen.
void consider_ties(const RefineInput& in, CrossValidation& validation);

/// Continues a fit with exact states, with unknown ones, if measurement noise is not small or R is given, unless
/// left-out runs, scored by fits to the other runs, lose more than least_gain.
Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, Fit fit,
                               MeasurementStage& stage);

}  // namespace modebank
