#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "filter/step/bank.hpp"

namespace modebank {

/// K linear regressions with a Markov chain that selects one per transition (Hamilton 1989, Econometrica 57(2)):
///   x[k+1] - x[k] = [A_j B_j (c_j)] phi_k + w, w ~ N(0, Q_j), P(j next | i now) = T_ij.
/// It is the bank's model with exactly measured states (R = 0). Its likelihood is exact.
struct SwitchingRegression {
  Eigen::MatrixXd theta;           ///< p x K
  std::vector<Eigen::MatrixXd> Q;  ///< K covariances of the measured states' noise, n x n each
  Eigen::MatrixXd transition;      ///< K x K; row i: the mode before a switch is i
  Eigen::VectorXd initial;         ///< K, probabilities before the first transition of a run, as in the filter
  TransitionLogit logit = {};      ///< dependence of T on x[k] and the acting inputs; empty if T is constant

  Index modes() const { return theta.cols(); }
};

/// The modes and transitions of a bank as a switching regression.
SwitchingRegression switching_model(const Bank& bank);

/// The bank `frame` with the modes, T and initial probabilities of `model`, without standard errors.
Bank with_modes(const Bank& frame, const SwitchingRegression& model);

/// The prior. Its log density, up to a constant, is added to the likelihood in expectation-maximisation.
struct SwitchingPrior {
  Eigen::VectorXd mean;            ///< p, mean of every mode's theta
  Eigen::MatrixXd information;     ///< p x p, inverse covariance of every mode's theta
  Eigen::MatrixXd noise;           ///< n x n, covariance of the `noise_transitions` additional transitions for Q
  double noise_transitions = 0.0;  ///< >= 0
  double counts = 0.0;             ///< >= 0, added to every expected count of switches and of first modes
  Eigen::VectorXd weight_sd = {};  ///< d, standard deviations of the logit's weights, normal about zero; empty if T is
                                   ///< constant
};

/// Smoothed mode probabilities given all transitions of the runs.
struct ModePosterior {
  Eigen::MatrixXd probability;  ///< N x K; also has rows for unusable transitions
  Eigen::MatrixXd switches;     ///< K x K, expected counts of the switch from i to j
  Eigen::VectorXd first;        ///< K, expected counts of each run's first mode
  double log_likelihood = 0.0;  ///< log-likelihood of all runs [nats]
  Eigen::MatrixXd pairs = {};   ///< K*K x N, probability of the switch from i to j at each transition, column-major;
                                ///< only with a logit
};

/// Forward-backward algorithm over every run. Each step is scaled by the largest density of a possible mode (log
/// domain). An unusable transition gives no information about its mode. Rows before a run's first usable transition are
/// zero. The log-likelihood equals that of the IMM filter for R
/// = 0.
ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// log p(transition | previous transitions of its run) for every row, N; 0 for rows before a run's first usable row.
/// The sum equals the log-likelihood of smooth_modes.
Eigen::VectorXd predictive_log_densities(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// Expected sums over the transitions. For each mode: the sums of its regression about the prediction by the prior's
/// mean. Transitions are weighted with the mode's probability. Also the expected counts of switches and first modes.
struct SwitchingSums {
  std::vector<RegressionSums> modes;  ///< K
  Eigen::MatrixXd switches;           ///< K x K, expected counts of the switch from i to j
  Eigen::VectorXd first;              ///< K, expected counts of each run's first mode
};

SwitchingSums sum_transitions(const TrainingTransitions& transitions, const ModePosterior& posterior,
                              const SwitchingPrior& prior);

/// Covariance of each mode's theta given the smoothed modes: (Q^-1 (x) sum g phi phi' + prior information)^-1. NaN if
/// the mode's Q or information is not definite.
std::vector<Eigen::MatrixXd> parameter_covariances(const SwitchingSums& sums, const SwitchingPrior& prior,
                                                   const SwitchingRegression& model);

/// Log density of the prior at `model`, up to a constant; minus infinity if a Q is not definite.
double log_prior(const SwitchingPrior& prior, bool one_theta, const SwitchingRegression& model);

}  // namespace modebank
