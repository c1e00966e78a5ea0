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

/// Start of a fit, its priors, and its number of iterations.
struct BankCandidate {
  std::string name;
  SwitchingRegression start;
  double noise_transitions = 0.0;
  double logit_width = 0.0;  ///< 0 for constant T
  Index iterations = 0;
  std::size_t row = 0;  ///< row in the table
};

/// Runs to learn from: all training runs, or those that a split leaves.
struct LearningRuns {
  const Recording& recording;
  Bank frame;  ///< the parts of the bank that are not refined, with a noise factor of these runs
  TrainingTransitions transitions;
  GlobalModel global;
};

/// Inputs of the refinement of a bank.
struct RefineInput {
  const WindowFits& fits;
  const RefineOptions& options;
  const FilterOptions& filter;
  LearningRuns all;

  SwitchingPrior prior(const BankCandidate& of, const LearningRuns& runs) const {
    return switching_prior(runs.transitions, runs.global, fits.prior_sd, of.noise_transitions, of.logit_width);
  }
  SwitchingEmOptions em() const { return {options.one_theta, options.tolerance}; }
  /// The smallest R in refinement, n_y: a negligible share of the global residual variance.
  Eigen::VectorXd least_R() const { return 1e-9 * fits.global.noise_variance(); }
};

/// The model accepted so far, and its fit to the training part of every split of the cross-validation.
struct Fit {
  BankCandidate candidate;  ///< with the number of iterations that scores best on left-out runs
  LeftOutScores scores = {};
  std::vector<Bank> of_splits = {};  ///< the fit without the left-out runs of each split; empty if no run is left out
  Bank bank = {};                    ///< set after expectation-maximisation on all training runs, like the rest
  SwitchingPrior prior = {};
  bool R_estimated = false;
};

/// Makes the candidate's iterations on all training runs. Then removes unusable modes one by one, each followed by a
/// few iterations. `screened` has the frame's, too; `objective` ends before the first removal.
SwitchingFit fit_training_runs(const RefineInput& in, const BankCandidate& candidate);

/// Scores of training runs that were left out, for every candidate: the likelihood of their complete transitions by the
/// switching regression (Hamilton 1989), which is the filter's at R = 0, else the filter's.
class CrossValidation {
 public:
  explicit CrossValidation(const RefineInput& in);

  /// Tries the candidates. Then chooses among all so far (fewest_modes_as_good); the first if no run can be left out.
  void consider(const std::vector<BankCandidate>& candidates);
  /// The fits of every split from one start, after the number of iterations that scores best.
  Fit best_iterations(BankCandidate candidate) const;

  bool possible() const { return !splits_.empty(); }  ///< whether any run can be left out
  const std::vector<ValidationSplit>& splits() const { return splits_; }
  const std::vector<LearningRuns>& learning() const { return learning_; }  ///< the data of each split for fits
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

  LeftOutScores exact_scores(const std::vector<SwitchingFit>& fits) const;
};

/// Decides whether transition probabilities depend on state and input, and how strongly. Every start's fit with
/// constant T continues as a logit on all training runs. The most likely is also tried with fewer modes, by merging one
/// pair after another: on one dead zone three modes that were fitted directly were 0.4 nats per sample worse than three
/// that came from merging six. Left-out runs choose the number of modes, then the width of the weights. Empty if
/// is_worth_it rejects the gain over constant T.
std::optional<Fit> choose_logit(const RefineInput& in, const CrossValidation& validation, SwitchingStage& stage);

struct MeasurementNoise {
  std::optional<Bank> bank;   ///< empty if R does not gain, or if every start failed
  SwitchingPrior prior = {};  ///< the prior with which the bank is most likely
  Index failed_starts = 0;    ///< whose likelihood is not finite, or which no step raised
  Index iterations = 0;       ///< of theta, Q, R and T together
  MeasuredFit end = MeasuredFit::none;
};

/// The bank whose theta, Q, R (diagonal) and T together maximise the filter's likelihood of these runs. The search
/// moves R and one factor on every Q first. If they gain nothing, theta moves, too: with the theta of exact states,
/// which takes in the noise, R = 0 may be most likely. Empty unless the search gains more than least_gain nats per
/// sample over the bank. `exact`: the prior of exact states.
MeasurementNoise find_measurement_noise(const RefineInput& in, const LearningRuns& runs, const SwitchingPrior& exact,
                                        const Bank& bank);

/// Whether at least half of the banks have a tenth of this R (traces).
bool mostly_have(const std::vector<Bank>& banks, const Eigen::MatrixXd& R);

/// Continues the fit with unknown states if R is not negligible.
/// - A given R, or that of rounding: theta, Q and T maximise the filter's likelihood.
/// - R is searched (find_measurement_noise), for rounded states beside the rounding. With more than eight state lags or
///   a noise factor, it is not.
/// Either is taken unless left-out runs, scored by fits to the other runs, lose more than least_gain, and R only if the
/// splits mostly_have it. `fit`: with exact states.
Fit fit_with_measurement_noise(const RefineInput& in, const CrossValidation& validation, Fit fit,
                               MeasurementStage& stage);

}  // namespace modebank
