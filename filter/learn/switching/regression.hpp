#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/step/bank.hpp"
#include "ident/model/local_model.hpp"

namespace modebank {

/// K linear regressions with a Markov chain that selects one per transition (Hamilton 1989, Econometrica 57(2)), the
/// bank's model with exactly measured states (R = 0): x[k+1] - x[k] = [A_j B_j (c_j)] phi_k + w, w ~ N(0, Q_j).
struct SwitchingRegression {
  Eigen::MatrixXd theta;           ///< p x K
  std::vector<Eigen::MatrixXd> Q;  ///< K covariances of the measured states' noise, n x n each
  Eigen::MatrixXd transition;      ///< K x K; row i: the mode before a switch is i
  Eigen::VectorXd initial;         ///< K, before the first transition of a run, as in the filter
  TransitionLogit logit = {};      ///< dependence of T on x[k] and the acting inputs; empty if T is constant
  std::vector<Index> motion = {};  ///< K, as in Bank, modes of one motion in a row; empty: each mode is one of its own
  Index noise_levels = 1;          ///< as in Bank

  Index modes() const { return theta.cols(); }
  /// The first mode after `first` that has another motion.
  Index end_of_motion(Index first) const {
    Index end = first + 1;
    while (!motion.empty() && end < modes() && motion[end] == motion[first]) ++end;
    return end;
  }
};

/// The chains of motions and of levels, whose Kronecker product T is; of any K x K sums of switches, the marginal sums.
std::pair<Eigen::MatrixXd, Eigen::MatrixXd> chains_of(const Eigen::MatrixXd& T, Index noise_levels);

SwitchingRegression switching_model(const Bank& bank);
/// The bank `frame` with the modes, T and initial probabilities of `model`, without standard errors.
Bank with_modes(Bank frame, const SwitchingRegression& model);

struct SwitchingPrior {
  Eigen::VectorXd mean;            ///< p, mean of every mode's theta
  Eigen::MatrixXd information;     ///< p x p, inverse covariance of every mode's theta
  Eigen::MatrixXd noise;           ///< n x n, covariance of the `noise_transitions` additional transitions for Q
  double noise_transitions = 0.0;  ///< >= 0
  double counts = 0.0;             ///< >= 0, added to every expected count of switches and of first modes
  Eigen::VectorXd weight_sd = {};  ///< d, standard deviations of the logit's weights about zero; empty without logit
};

/// The prior described in refine.hpp. `prior_sd`: p standard deviations, or empty. `logit_width`: standard deviation of
/// a logit's weights in units of 1 / standard deviation of the regressors; 0 means constant T. Throws DataError if the
/// residual covariance of the global model is singular.
SwitchingPrior switching_prior(const TrainingTransitions& transitions, const GlobalModel& global,
                               const Eigen::VectorXd& prior_sd, double noise_transitions, double logit_width = 0.0);

/// Log density of the prior at `model`, up to a constant; minus infinity if a Q is not definite.
double log_prior(const SwitchingPrior& prior, const SwitchingRegression& model);

/// Smoothed mode probabilities given all transitions of the runs.
struct ModePosterior {
  Eigen::MatrixXd probability;  ///< N x K; also has rows for unusable transitions
  Eigen::MatrixXd switches;     ///< K x K, expected counts of the switch from i to j
  Eigen::VectorXd first;        ///< K, expected counts of each run's first mode
  double log_likelihood = 0.0;  ///< log-likelihood of all runs [nats]
  Eigen::MatrixXd pairs = {};  ///< K*K x N, probability of the switch from i to j at each transition; only with a logit
};

/// Forward-backward algorithm over every run, from its first usable transition. The log-likelihood equals that of the
/// IMM filter for R = 0.
ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// log p(transition | previous transitions of its run), N; the sum is the log-likelihood of smooth_modes.
Eigen::VectorXd predictive_log_densities(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// Sums of each mode's regression about `theta`, weighted by the mode's probability.
std::vector<RegressionSums> sums_of_modes(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                          const Eigen::VectorXd& theta);

/// Weight of the prior on Q while starts are compared, in transitions.
inline constexpr double usual_Q_transitions = 4.0;

struct SwitchingEmOptions {
  double tolerance = 1e-6;  ///< nats per transition; the fit has converged if the objective gains less
  int alternations = 3;     ///< between theta and Q in one maximisation
};

/// The model with the largest expected log posterior near `model`, from which the posterior comes: theta and Q
/// alternate (ECM: Meng & Rubin 1993); T and initial probabilities are exact but for a logit (raise_switching).
SwitchingRegression maximise(const TrainingTransitions& transitions, const ModePosterior& posterior,
                             const SwitchingPrior& prior, const SwitchingEmOptions& options, SwitchingRegression model);

/// A logit without effect, as a start. Its reference is the mean of the regressors (x, v).
TransitionLogit no_effect(const TrainingTransitions& transitions, Index modes);

/// Raises the expected log posterior of the switches over T and the logit's weights together: one Newton step on this
/// concave objective (McCullagh & Nelder 1989, section 5.2), halved until it rises. So the likelihood never falls.
void raise_switching(const TrainingTransitions& transitions, const ModePosterior& posterior,
                     const SwitchingPrior& prior, SwitchingRegression& model);

struct SwitchingFit {
  SwitchingRegression model;
  ModePosterior posterior = {};        ///< of the model; empty before the first iteration
  std::vector<double> objective = {};  ///< penalised log-likelihood before each iteration
  bool converged = false;
  std::vector<ScreenedMode> screened = {};  ///< modes removed from the fit
};

/// Expectation-maximisation: `iterations` more, or fewer if the fit converges.
void iterate(const TrainingTransitions& transitions, const SwitchingPrior& prior, const SwitchingEmOptions& options,
             Index iterations, SwitchingFit& fit);

/// A start whose modes are each fitted to a random stretch of `length` transitions, with the prior. Stretches do not
/// overlap if there is room. T favours staying.
SwitchingRegression start_from_stretches(const TrainingTransitions& transitions, const SwitchingPrior& prior,
                                         Index modes, Index length, std::uint64_t seed, Index index);

/// Removes the model's worst unusable mode and returns it; empty if all modes are usable. The last mode always stays.
/// Reasons, worst first:
/// - "starved": the mode has fewer effective transitions than regressors + 1.
/// - "unstable": the spectral radius of I + A is above 1 and the mode has less than least_unstable_share of the
///   transitions. The largest radius comes first.
/// - "duplicate" of another mode, which takes its transitions: pooling both costs less than a likelihood-ratio test at
///   5 % would detect. The cost is the bound of Runnalls 2007, IEEE Trans. AES 43(3): the increase of 1/2 sum W log det
///   Q.
/// Modes of a product with noise levels stay.
std::optional<ScreenedMode> drop_worst_mode(const TrainingTransitions& transitions, const ModePosterior& posterior,
                                            SwitchingRegression& model);

/// An unstable mode with this share of the transitions stays: the loop bounds the data, and left-out scores judge it.
inline constexpr double least_unstable_share = 0.05;

/// Merges the pair of modes whose pooling costs least (see "duplicate" above). Requires at least two modes.
void merge_closest_pair(const TrainingTransitions& transitions, const ModePosterior& posterior,
                        SwitchingRegression& model);

}  // namespace modebank
