#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/training_transitions.hpp"
#include "ident/enum_names.hpp"

namespace modebank {

/// K linear regressions of which a Markov chain picks one per transition (Hamilton 1989, Econometrica 57(2)):
///   x[k+1] - x[k] = [A_j B_j (c_j)] phi_k + w, w ~ N(0, Q_j), P(j next | i now) = T_ij.
/// The bank's model with the state measured exactly (R = 0), where its likelihood needs no approximation.
struct SwitchingRegression {
  Eigen::MatrixXd theta;           ///< p x K
  std::vector<Eigen::MatrixXd> Q;  ///< K of n x n, of the measured states
  Eigen::MatrixXd transition;      ///< K x K, row = from
  Eigen::VectorXd initial;         ///< K, before the step to a run's first transition, as the filter has it

  Index modes() const { return theta.cols(); }
};

/// What is believed before the data. Its log density, up to a constant, is added to the likelihood that
/// expectation-maximisation raises.
struct SwitchingPrior {
  Eigen::VectorXd mean;         ///< p, of every mode's theta
  Eigen::MatrixXd information;  ///< p x p, inverse covariance of every mode's theta
  Eigen::MatrixXd noise;        ///< n x n: Q is as if `noise_transitions` more transitions of this covariance were seen
  double noise_transitions = 0.0;  ///< >= 0
  double counts = 0.0;             ///< >= 0, added to every expected count of switches and of first modes
};

/// What the modes have in common: nothing, theta (they differ in noise), or Q (they differ in theta).
enum class SharedParts { none, theta, noise };

template <>
struct EnumNames<SharedParts> {
  static constexpr Names<3> values{"none", "theta", "noise"};
};

/// Smoothed mode probabilities given all transitions of the runs.
struct ModePosterior {
  Eigen::MatrixXd probability;  ///< N x K; rows of unusable transitions too
  Eigen::MatrixXd switches;     ///< K x K expected counts of (i, then j)
  Eigen::VectorXd first;        ///< K expected counts of the modes that runs start from
  double log_likelihood = 0.0;  ///< nats, of all runs
};

/// Forward-backward over every run, each step scaled by its largest density (the log domain). An unusable transition
/// says nothing about its mode (rows before a run's first usable one stay zero); a sample weight is the power of its
/// density. The log-likelihood is that of the IMM filter for R = 0.
ModePosterior smooth_modes(const TrainingTransitions& transitions, const SwitchingRegression& model);

/// What a mode's regression needs to know of the transitions: expected sums over them, each weighted with the mode's
/// probability g; r = increment minus what the prior's mean predicts.
struct ModeSums {
  Eigen::MatrixXd G;         ///< q x q, sum g phi phi'
  Eigen::MatrixXd H;         ///< q x n, sum g phi r'
  Eigen::MatrixXd S;         ///< n x n, sum g r r'
  double transitions = 0.0;  ///< sum g
};

/// All modes' sums and how the modes follow each other.
struct SwitchingSums {
  std::vector<ModeSums> modes;  ///< K
  Eigen::MatrixXd switches;     ///< K x K expected counts of (i, then j)
  Eigen::VectorXd first;        ///< K expected counts of the modes that runs start from
};

/// The sums over transitions that were measured exactly.
SwitchingSums sum_transitions(const TrainingTransitions& transitions, const ModePosterior& posterior,
                              const SwitchingPrior& prior);

/// Raises the expected log posterior of `model`: theta given Q, then Q given theta, a few times each (ECM: Meng & Rubin
/// 1993), T and initial probabilities exactly. `model` holds the parameters that the sums were computed with.
void maximise(const LinearStructure& structure, const SwitchingSums& sums, const SwitchingPrior& prior,
              SharedParts shared, SwitchingRegression& model);

/// Covariance of each mode's theta, (Q^-1 (x) sum g phi phi' + prior information)^-1, given the smoothed modes.
std::vector<Eigen::MatrixXd> parameter_covariances(const SwitchingSums& sums, const SwitchingPrior& prior,
                                                   const SwitchingRegression& model);

/// Log density of the prior at `model`, up to a constant.
double log_prior(const SwitchingPrior& prior, SharedParts shared, const SwitchingRegression& model);

}  // namespace modebank
