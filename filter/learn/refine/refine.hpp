#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/refine/tuning.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

struct RefineOptions {
  Index max_iterations = 100;     ///< of expectation-maximisation
  double tolerance = 1e-6;        ///< nats per transition: stop when the objective gains less
  Index restarts = 2;             ///< starts from random stretches of the runs besides the mixture's
  Index members = 1;              ///< fits from different starts that are averaged at most (averaging.hpp)
  Index folds = 6;                ///< parts of the cross-validation; 1: none, every start runs to convergence
  bool measurement_noise = true;  ///< R by maximum likelihood of the filter on the training runs; false: the start's R
  bool screen = true;             ///< take unstable, starved and duplicate modes out
  bool one_theta = false;         ///< all modes have the same theta and differ in Q: the rival that knows one motion
  std::uint64_t seed = 1;
  RefineTuning tuning;
};

/// One row of the cross-validation inside the training runs.
struct RefineCandidate {
  std::string start;  ///< "mixture" or "stretches 1"
  Index modes = 0;
  double noise_transitions = 0.0;  ///< how many transitions the prior on Q is worth
  Index iterations = 0;
  double score = 0.0;     ///< mean log score of the runs left out, nats per sample; NaN without cross-validation
  bool selected = false;  ///< several where fits are averaged
};

/// How the fit went on once R was known to be more than nothing.
struct MeasurementStage {
  Index iterations = 0;  ///< with measurement noise; 0: there is none, or they would not have paid
  MeasuredFit end = MeasuredFit::none;
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out
  double score = std::numeric_limits<double>::quiet_NaN();  ///< the same after them; NaN without cross-validation or R
};

/// What averaging several fits was worth.
struct Averaging {
  Index members = 1;  ///< fits in the bank; those of the candidates that are marked as selected
  double score_before = std::numeric_limits<double>::quiet_NaN();  ///< mean log score of the runs left out: one fit
  double score = std::numeric_limits<double>::quiet_NaN();         ///< the same of `members` fits
};

struct Refinement {
  Bank bank;
  Bank start;                               ///< the mixture's bank
  std::vector<RefineCandidate> candidates;  ///< the best number of iterations of each start
  std::vector<double> objective;  ///< penalised log-likelihood of the training transitions before each iteration
  MeasurementStage measurement;
  Averaging averaging = {};
};

/// Expectation-maximisation of the switching model (switching_regression.hpp) from banks of mixtures. Which start, how
/// many iterations and, for an adaptive filter, how the noise scale moves is decided by the score
/// of training runs that were left out, each in the filter that will run the bank; test runs never enter. The last fit
/// uses all training runs; unstable, starved and duplicate modes are then screened and listed, and the rest refined on.
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
/// more than least_gain (tuning.hpp). Requires linear or lagged linear banks of one structure; throws
/// std::invalid_argument for a motion model's.
Refinement refine_bank(const Recording& recording, const WindowFits& fits, const std::vector<Bank>& starts,
                       const RefineOptions& options, const FilterOptions& filter);

}  // namespace modebank
