#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "modebank/learn/options.hpp"
#include "modebank/learn/results.hpp"

namespace modebank {

struct Refinement {
  Bank bank;
  Bank start;                               ///< the bank of the mixture
  std::vector<RefineCandidate> candidates;  ///< best number of iterations for each start
  std::vector<double> objective;  ///< penalised log-likelihood of the training transitions, one value per iteration,
                                  ///< before the iteration
  MeasurementStage measurement;
  SwitchingStage switching = {};
  /// The fits to the training part of each split (validation_splits), in the order of the splits. They are used for
  /// scores on unseen runs. Empty if no run was left out.
  std::vector<Bank> of_splits = {};
  Eigen::Index learned_transitions = 0;  ///< number of transitions in the part of the training runs that was used
                                         ///< (left_out/folds.hpp); 0 means all
};

/// Expectation-maximisation of the switching model (regression.hpp), starting from banks of mixtures.
/// - The score of left-out training runs, in the bank's own filter, decides the start and the number of iterations.
///   Held-out runs are never used.
/// - Among starts that are as good as the best, the one with the fewest modes is chosen (fewest_modes_as_good).
/// - The last fit uses all training runs. Unstable, starved and duplicate modes are then removed and listed, and the
///   other modes are refined further.
///
/// The prior:
/// - theta is normal about the global model. Its standard deviation is prior_sd of the windows. Without prior_sd, the
///   prior is worth one transition (unit information: Kass & Wasserman 1995).
/// - Q has 1, 4 or 16 additional transitions of the global residual covariance, chosen by cross-validation.
/// - Every count of T and of first modes has 0.1 added.
///
/// States first count as measured exactly, which is right for R = 0. Otherwise Q contains the measurement noise and
/// theta is biased (errors in variables). R and the remaining Q are then estimated by the filter's likelihood
/// (measurement_noise.hpp) and kept if the result is better. If R is estimated or given, the fit continues with unknown
/// states: theta, Q, R and T together maximise the filter's likelihood of the training runs. This likelihood is exact
/// for one mode; for several it is the approximation of the IMM. The result is kept unless it costs more than
/// least_gain (tuning.hpp) on the left-out runs. Requires linear or lagged linear banks of one structure; throws
/// std::invalid_argument for a motion model.
Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& starts,
                       const RefineOptions& options, const FilterOptions& filter);

/// Fits the theta of one motion to its errors up to `horizon` samples ahead (ident/fit/horizon_fit.hpp). Noise and
/// transitions then maximise the likelihood with that theta. `one_motion`: from refine_bank with these runs and
/// options. It is changed if the errors of free runs after `measured` samples fall on left-out runs, by the rule
/// (left_out/rule.hpp). Returns whether it is. The result has no standard errors.
bool fit_horizon(const Recording& recording, const RefineOptions& options, Eigen::Index horizon, Eigen::Index measured,
                 Refinement& one_motion);

}  // namespace modebank
