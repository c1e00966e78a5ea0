// Modes of a motion model, linearised.
#include <algorithm>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/fit/motion_fit.hpp"

namespace modebank {
namespace {

constexpr int max_passes = 50;
constexpr double pass_tolerance = 1e-10;  // stopping tolerance: relative change of the diagonal of Q
constexpr int search_iterations = 200;

/// sum g r r' / W, with a floor; the global covariance if no transition has weight. W is the sum of the weights g.
Eigen::MatrixXd weighted_scatter(const ModelResiduals& residuals, const Eigen::VectorXd& theta, double W,
                                 const GlobalModel& global) {
  const Index n = residuals.states();
  Eigen::VectorXd r;
  residuals.evaluate(theta.data(), r, nullptr);
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(n, n);
  for (Index k = 0; k < residuals.samples(); ++k)
    scatter += residuals.weight(k) * r.segment(k * n, n) * r.segment(k * n, n).transpose();
  if (!(W > 0.0)) return global.residual_covariance;
  return floored_process_noise(scatter / W, global);
}

/// (sum g J' Q^-1 J + prior)^-1, with Q corrected for the number of fitted parameters. NaN if theta is not determined.
Eigen::MatrixXd motion_covariance(const ModelResiduals& residuals, const ModeEstimate& mode,
                                  const ParameterPrior* prior) {
  const Index n = residuals.states(), p = residuals.unknowns();
  const double W = mode.effective_transitions;
  const double lost = static_cast<double>(p) / static_cast<double>(n);
  const Eigen::MatrixXd Q_inverse = solve_semidefinite(mode.Q, Eigen::MatrixXd(Eigen::MatrixXd::Identity(n, n))) *
                                    (std::max(W - lost, 1.0) / std::max(W, 1.0));
  Eigen::VectorXd r;
  RowMajorJacobian J;
  residuals.evaluate(mode.motion_theta.data(), r, &J);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(p, p);
  for (Index k = 0; k < residuals.samples(); ++k)
    information += residuals.weight(k) * J.middleRows(k * n, n).transpose() * Q_inverse * J.middleRows(k * n, n);
  if (prior) information.diagonal() += prior->sd.array().square().inverse().matrix();
  const Eigen::VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Cholesky factor(scale.asDiagonal() * information * scale.asDiagonal());
  if (!factor.definite() || factor.rcond() < excitation_tolerance * excitation_tolerance)
    return Eigen::MatrixXd::Constant(p, p, not_a_number);
  return scale.asDiagonal() * factor.inverse() * scale.asDiagonal();
}

/// Alternates between theta and the residual variances until both converge.
void estimate_theta(const ModelResiduals& residuals, const GlobalModel& global, const ParameterPrior* prior,
                    ModeEstimate& mode) {
  const RobustLoss least_squares(Loss::trivial, 0.0);
  mode.converged = false;
  for (int pass = 0; pass < max_passes && !mode.converged; ++pass) {
    const Eigen::VectorXd variance = mode.Q.diagonal();
    const ModelMinimum minimum =
        minimise_model(residuals, variance.cwiseSqrt(), least_squares, prior, {search_iterations}, mode.motion_theta);
    if (minimum.status == FitStatus::failed) return;
    mode.motion_theta = minimum.theta;
    mode.Q = weighted_scatter(residuals, mode.motion_theta, mode.effective_transitions, global);
    mode.converged = (mode.Q.diagonal() - variance).norm() <= pass_tolerance * variance.norm();
  }
}

}  // namespace

ModeEstimate fit_motion_mode(const Recording& recording, const MotionModel& model, const Eigen::VectorXd& weights,
                             const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given) {
  const ModelResiduals residuals(model, training_stretches(recording), weights);
  ModeEstimate mode;
  mode.motion_theta = given ? *given : global.theta;
  for (Index k = 0; k < residuals.samples(); ++k) mode.effective_transitions += residuals.weight(k);
  mode.Q = weighted_scatter(residuals, mode.motion_theta, mode.effective_transitions, global);
  if (!given) estimate_theta(residuals, global, prior, mode);

  const Eigen::MatrixXd covariance = motion_covariance(residuals, mode, prior);
  mode.motion_standard_error = covariance.diagonal().cwiseSqrt();
  const LinearisedMotion linear = linearise(model, mode.motion_theta, operating_point(recording, weights));
  mode.by_motion = linear.by_motion;
  mode.theta = linear.theta;
  mode.standard_error =
      (linear.by_motion * covariance * linear.by_motion.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt();
  return mode;
}

}  // namespace modebank
