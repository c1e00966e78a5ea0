#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"
#include "ident/model/motion_model.hpp"
#include "mixture/select.hpp"

namespace modebank {

/// Clusters windows by the features of the options (FeatureSet), which may be of one-lag fits of the same windows.
/// `window`: the options of `fits`.
MixtureResult cluster_windows(const Recording& recording, const WindowFits& fits, const FitOptions& window,
                              const ClusterOptions& options, std::uint64_t seed);

/// Membership of each training transition in each mixture component, N x K: the mean responsibility of the clustered
/// windows that cover it; else that of the nearest clustered window of its run (the earlier one on a tie); in a run
/// without clustered windows the mixture weights. The row sums to one less the probability of noise. Rows of unusable
/// transitions are zero.
Eigen::MatrixXd transition_memberships(const TrainingTransitions& transitions, const WindowFits& fits,
                                       const MixtureResult& mixture);

/// Smallest eigenvalue of a mode's Q, as a share of the global residual variance of each state: a handful of
/// transitions can be fitted almost exactly by chance.
inline constexpr double process_noise_floor = 1e-6;

/// Rounding as a share of a variance. It keeps a variance positive if the data suggest zero.
inline constexpr double rounding_share = 1e-12;

/// A residual variance, the unit of both shares. It is positive even for exact data, so that inverses stay finite.
inline double positive_variance(double variance) { return std::max(variance, 1e-100); }

/// One mode from weighted transitions.
struct ModeEstimate {
  Eigen::VectorXd theta;  ///< p; of a motion model, linearised at the mode's weighted mean state and input
  Eigen::MatrixXd Q;      ///< n x n, weighted scatter about theta / sum of weights; at least process_noise_floor
  Eigen::VectorXd standard_error;      ///< p, standard errors of theta; NaN if neither data nor prior determine theta
  double effective_transitions = 0.0;  ///< sum of weights

  // Of a motion model only; standard errors of theta are propagated by the derivative.
  Eigen::VectorXd motion_theta = {};           ///< p_motion
  Eigen::VectorXd motion_standard_error = {};  ///< p_motion
  Eigen::MatrixXd by_motion = {};              ///< derivative of theta by motion_theta
};

/// Maximises the following by alternating between theta and Q until both converge:
///   -1/2 sum_k g_k (log det Q + r_k' Q^-1 r_k) - 1/2 (theta - m)' P^-1 (theta - m),   r_k = d_k - [A B (c)] phi_k.
/// g are the weights (N, nonnegative), (m, P) the Gaussian prior (`prior` may be null). Directions of theta that
/// neither data nor prior determine stay at the global model. Standard errors are the square roots of the diagonal of
/// (Q_u^-1 (x) sum g phi phi' + P^-1)^-1. Q_u = Q W / (W - q) removes the bias of q fitted regressors, with W = sum of
/// weights. `given`: a fixed theta that is only assessed; null to estimate theta.
ModeEstimate fit_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                               const GlobalModel& global, const ParameterPrior* prior,
                               const Eigen::VectorXd* given = nullptr);

/// fit_weighted_mode for motion models: weighted least squares of the one-step residuals and the prior, alternating
/// with updates of the residual variances.
ModeEstimate fit_motion_mode(const Recording& recording, const MotionModel& model, const Eigen::VectorXd& weights,
                             const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given);

/// What the spectral radius of I + A may exceed 1 by, so that rounding rejects no integrator (A = 0).
inline constexpr double spectral_radius_slack = 1e-9;

}  // namespace modebank
