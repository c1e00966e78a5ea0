#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/run/evaluate.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

/// What a fit that looks ahead was worth (look_ahead_fit.hpp).
struct LookAheadStage {
  double score_before = 0.0;         ///< mean look-ahead score of the runs left out [nats per sample]
  double score = 0.0;                ///< the same of the fits taken on; equal to the other where that was not tried
  double gain_standard_error = 0.0;  ///< of the difference, by run
  bool taken = false;
  bool of_errors = false;  ///< scores are minus half of mean squared errors, in no unit
};

struct Refinement {
  Bank bank;
  Bank start;                               ///< the mixture's bank
  std::vector<RefineCandidate> candidates;  ///< the best number of iterations of each start
  std::vector<double> objective;  ///< penalised log-likelihood of the training transitions before each iteration
  MeasurementStage measurement;
  SwitchingStage switching = {};
  DriftStage drift = {};
  LookAheadStage look_ahead = {};
  /// The same fit to the training part of each split (validation_splits), in their order, to be scored on what it has
  /// not seen; empty where nothing was left out.
  std::vector<Bank> of_splits = {};
  Eigen::Index learned_transitions = 0;  ///< that a part of the training runs has (learning_part.hpp); 0: all
};

/// Expectation-maximisation of the switching model (switching_regression.hpp) from banks of mixtures. Which start, how
/// many iterations and, for an adaptive filter, how the noise scale moves is decided by the score
/// of training runs that were left out, each in the filter that will run the bank; test runs never enter. Of starts
/// that these runs do not tell from the best the one with the fewest modes is chosen (fewest_modes_as_good). The last
/// fit uses all training runs; unstable, starved and duplicate modes are then screened and listed, and the rest refined
/// on.
///
/// The prior: theta normal about the global model with the windows' prior_sd, or worth one transition where there is
/// none (unit information: Kass & Wasserman 1995); Q as if 1, 4 or 16 more transitions of the global residual
/// covariance were seen, whichever the cross-validation likes most; 0.1 on every count of T and of first modes.
///
/// The state counts as measured exactly at first, which is exact for R = 0; otherwise it leaves measurement noise in Q
/// and draws theta to errors-in-variables. R, and with it how much of Q is left, is then estimated by the filter's
/// likelihood (measurement_noise.hpp) and kept where that is better. Where it is, or where R was given, the fit goes on
/// with the states unknown, all of theta, Q, R and T together, to the maximum of the filter's likelihood of the
/// training runs: exact for one mode, the IMM's for several. That is kept unless the runs left out say that it costs
/// more than least_gain (tuning.hpp). Where modes drift (choose_drift, drift.hpp) R is zero. Requires linear or lagged
/// linear banks of one structure; throws std::invalid_argument for a motion model's.
Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& starts,
                       const RefineOptions& options, const FilterOptions& filter);

}  // namespace modebank
