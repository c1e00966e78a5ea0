#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// K linear regressions of which a Markov chain picks one per transition (Hamilton 1989, Econometrica 57(2)):
///   x[k+1] - x[k] = [A_j B_j (c_j)] phi_k + w, w ~ N(0, Q_j), P(j next | i now) = T_ij.
/// The bank's model with the state measured exactly (R = 0), where its likelihood needs no approximation.
struct SwitchingRegression {
  Eigen::MatrixXd theta;           ///< p x K
  std::vector<Eigen::MatrixXd> Q;  ///< K of n x n, of the measured states
  Eigen::MatrixXd transition;      ///< K x K, row = from
  Eigen::VectorXd initial;         ///< K, before the step to a run's first transition, as the filter has it
  TransitionLogit logit = {};      ///< how x[k] and the inputs that act on the step change T; empty: not at all

  Index modes() const { return theta.cols(); }
};

/// A bank's modes and sequence as a switching regression.
SwitchingRegression switching_model(const Bank& bank);

/// The modes, T and first modes of `model` put in place of a bank's, everything else as there. Standard errors are not
/// known yet.
Bank with_modes(const Bank& frame, const SwitchingRegression& model);

/// What is believed before the data. Its log density, up to a constant, is added to the likelihood that
/// expectation-maximisation raises.
struct SwitchingPrior {
  Eigen::VectorXd mean;         ///< p, of every mode's theta
  Eigen::MatrixXd information;  ///< p x p, inverse covariance of every mode's theta
  Eigen::MatrixXd noise;        ///< n x n: Q is as if `noise_transitions` more transitions of this covariance were seen
  double noise_transitions = 0.0;  ///< >= 0
  double counts = 0.0;             ///< >= 0, added to every expected count of switches and of first modes
  Eigen::VectorXd weight_sd = {};  ///< d, of the logit's weights, normal about zero; empty: T is the same everywhere
  /// Of what rows and columns of a logit's log T do not explain (memory_of), normal about zero: where it is small, the
  /// mode before hardly matters and modes are a function of state and input, as in a piecewise affine system.
  double memory_sd = std::numeric_limits<double>::infinity();
};

/// Smoothed mode probabilities given all transitions of the runs.
struct ModePosterior {
  Eigen::MatrixXd probability;  ///< N x K; rows of unusable transitions too
  Eigen::MatrixXd switches;     ///< K x K expected counts of (i, then j)
  Eigen::VectorXd first;        ///< K expected counts of the modes that runs start from
  double log_likelihood = 0.0;  ///< nats, of all runs
  Eigen::MatrixXd pairs = {};   ///< K*K x N, P(i, then j) at each transition, column-major; of a logit alone
};

/// Forward-backward over every run, each step scaled by the largest density of a possible mode (the log domain). An
/// unusable transition says nothing about its mode (rows before a run's first usable one stay zero); a sample weight is
/// the power of its density. The log-likelihood is that of the IMM filter for R = 0.
ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// log p(transition | those before it in its run) of every row, N; 0 of rows before a run's first usable one. Their sum
/// is smooth_modes' log-likelihood.
Eigen::VectorXd predictive_log_densities(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// Expected sums over the transitions: of every mode's regression, each weighted with the mode's probability, about
/// what the prior's mean predicts, and how the modes follow each other.
struct SwitchingSums {
  std::vector<RegressionSums> modes;  ///< K
  Eigen::MatrixXd switches;           ///< K x K expected counts of (i, then j)
  Eigen::VectorXd first;              ///< K expected counts of the modes that runs start from
};

SwitchingSums sum_transitions(const TrainingTransitions& transitions, const ModePosterior& posterior,
                              const SwitchingPrior& prior);

/// Covariance of each mode's theta, (Q^-1 (x) sum g phi phi' + prior information)^-1, given the smoothed modes.
/// NaN of a mode whose Q or information is not definite: nothing is known of its errors.
std::vector<Eigen::MatrixXd> parameter_covariances(const SwitchingSums& sums, const SwitchingPrior& prior,
                                                   const SwitchingRegression& model);

/// What the mode before adds to the log odds of the next: log T without the means of its rows and columns. K x K.
Eigen::MatrixXd memory_of(const Eigen::MatrixXd& log_T);
/// The matrix that takes log T, row by row, to that. K^2 x K^2.
Eigen::MatrixXd memory_projection(Index modes);

/// Log density of the prior at `model`, up to a constant; minus infinity where a Q is not definite.
double log_prior(const SwitchingPrior& prior, bool one_theta, const SwitchingRegression& model);

}  // namespace modebank
