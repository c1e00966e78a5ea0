#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <string>

#include "filter/learn/from_mixture/training_transitions.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/fit/prior.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Smallest eigenvalue of a mode's Q, as a share of the global residual variance of each state. A handful of
/// transitions can be fitted almost exactly by chance; without this floor they would count as exact.
inline constexpr double process_noise_floor = 1e-6;

/// Rounding as a share of a variance (a millionth of the standard deviation). It keeps a variance positive if the data
/// suggest zero. Other variances hardly change.
inline constexpr double rounding_share = 1e-12;

/// A residual variance, the unit of the two shares above. It is positive even for exact data, so that inverses stay
/// finite.
inline double positive_variance(double variance) { return std::max(variance, 1e-100); }

/// One mode from weighted transitions.
struct ModeEstimate {
  Eigen::VectorXd theta;  ///< p; of a motion model, the vec of [A B c] at the mode's weighted mean state and input
  Eigen::MatrixXd Q;      ///< n x n, weighted scatter about theta / sum of weights; at least process_noise_floor
  Eigen::VectorXd standard_error;      ///< p, standard errors of theta; NaN if neither data nor prior determine theta
  double effective_transitions = 0.0;  ///< sum of weights
  bool converged = true;               ///< whether theta and Q converged within the iteration limit and Q is positive
                                       ///< definite

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
/// weights. For K = 1 without a prior, theta, Q and standard errors are the global model's. `given`: a fixed theta that
/// is only assessed; null to estimate theta.
ModeEstimate fit_weighted_mode(const TrainingTransitions& transitions, const Eigen::VectorXd& weights,
                               const GlobalModel& global, const ParameterPrior* prior,
                               const Eigen::VectorXd* given = nullptr);

/// fit_weighted_mode for motion models: weighted least squares of the one-step residuals and the prior. The fit
/// alternates with updates of the residual variances. `weights`: one per training transition. Q is the weighted scatter
/// / sum of weights, with the floor of a linear mode.
ModeEstimate fit_motion_mode(const Recording& recording, const MotionModel& model, const Eigen::VectorXd& weights,
                             const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given);

/// Raises the eigenvalues of a process noise covariance to the floor. The floor is in units of the global residual
/// variances.
Eigen::MatrixXd floored_process_noise(const Eigen::MatrixXd& Q, const GlobalModel& global);

/// Limit for the spectral radius of I + A. It is slightly above 1, so that an integrator (A = 0) is not rejected
/// because of rounding.
inline constexpr double spectral_radius_slack = 1e-9;

/// Reason why a bank cannot use a mode: "starved" (fewer effective transitions than regressors + 1) or "unstable"
/// (spectral radius of I + A above 1). Empty if the mode is usable.
std::string screening_reason(const LinearStructure& structure, const ModeEstimate& mode);

}  // namespace modebank
