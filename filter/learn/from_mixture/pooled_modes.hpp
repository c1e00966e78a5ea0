#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/training_transitions.hpp"
#include "ident/fit_window.hpp"

namespace modebank {

/// One mode from weighted transitions.
struct ModeEstimate {
  Eigen::VectorXd theta;           ///< p
  Eigen::MatrixXd Q;               ///< n x n, weighted scatter about theta / sum of weights; floored (noise_floor.hpp)
  Eigen::VectorXd standard_error;  ///< p, of theta; NaN when neither data nor prior determine theta
  double effective_transitions = 0.0;  ///< sum of weights
  bool converged = true;               ///< whether theta and Q stopped changing within the bounded iterations
};

/// Maximises, alternating between theta and Q until both stand still,
///   -1/2 sum_k g_k (log det Q + r_k' Q^-1 r_k) - 1/2 (theta - m)' P^-1 (theta - m),   r_k = d_k - [A B (c)] phi_k,
/// with weights g (N, nonnegative) and the Gaussian prior (m, P) where there is one (`prior` may be null). Directions
/// of theta that neither data nor prior determine stay at the global model. Standard errors are the square roots of
/// the diagonal of (Q_u^-1 (x) sum g phi phi' + P^-1)^-1, Q_u = Q W / (W - q) free of the bias of q fitted regressors,
/// W = sum of weights: for K = 1 without a prior theta, Q and standard errors are the global model's.
ModeEstimate fit_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                               const GlobalModel& global, const ParameterPrior* prior);

/// Q and standard errors of a mode whose theta is given, from the same weights.
ModeEstimate assess_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                                  const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd& theta);

/// A process noise covariance whose eigenvalues, in units of the global residual variances, are raised to the floor.
Eigen::MatrixXd floored_process_noise(const Eigen::MatrixXd& Q, const GlobalModel& global);

/// One mode per column of `memberships` (N x K), in parallel; mode k depends on column k alone.
std::vector<ModeEstimate> fit_pooled_modes(const TrainingTransitions& transitions, const Eigen::MatrixXd& memberships,
                                           const GlobalModel& global, const ParameterPrior* prior);

}  // namespace modebank
