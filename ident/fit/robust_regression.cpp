#include "ident/fit/robust_regression.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/covariance.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/minimise.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double normal_third_quartile = 0.674489750196081743;  // Phi^-1(3/4)

// relative to the scale; rounding errors are some decades smaller
constexpr double fit_tolerance = 1e-12;
constexpr int max_iterations = 1000;

// as a share of the errors' root mean square; needed because more than half of the errors may be zero
constexpr double least_share_of_rms = 1e-3;
constexpr double least_normal_scale = 1e-150;  // the square of this value is still a normal floating-point number

double uncentred_scale(const VectorXd& residuals) { return median(residuals.cwiseAbs()) / normal_third_quartile; }

Transitions one_response(const Transitions& all, Index i) { return {all.regressors, all.increments.col(i)}; }

struct ResponseFit {
  VectorXd coefficients;    // q
  VectorXd standard_error;  // q
  double scale = 0.0;
  bool converged = false;
};

/// Standard errors for a problem of scale 1. If the problem is rank deficient, only the directions that data determine
/// are included.
VectorXd standard_errors(const WhitenedProblem& problem, const RobustLoss& loss, const VectorXd& residuals,
                         double scale) {
  const Index q = problem.basis.rows(), rank = problem.unknowns();
  if (problem.samples <= rank && scale != 0.0) return VectorXd::Constant(q, not_a_number);
  if (scale == 0.0) return VectorXd::Zero(q);
  const RobustTerms terms = evaluate_at(problem, loss, residuals / scale);
  const auto covariance = [&](const WhitenedProblem& of) {
    return theta_covariance({of, terms, rank, VectorXd::Zero(1)}, CovarianceKind::model);
  };
  if (rank == q) return scale * covariance(problem).diagonal().cwiseSqrt();
  WhitenedProblem determined = problem;
  determined.basis = MatrixXd::Identity(rank, rank);
  return scale * (problem.basis * covariance(determined) * problem.basis.transpose()).diagonal().cwiseSqrt();
}

/// Reweighted least squares on one problem. Every step updates the scale.
ResponseFit fit_response(const Transitions& transitions, const Decomposition& design) {
  const WhitenedProblem problem = whiten(transitions, design, VectorXd::Ones(1), nullptr);
  const RobustLoss loss(Loss::huber, default_loss_scale(Loss::huber));
  ResponseFit fit;
  VectorXd z = VectorXd::Zero(problem.unknowns()), residuals = problem.b;
  fit.scale = uncentred_scale(residuals);
  for (int i = 0; i < max_iterations && fit.scale > 0.0 && !fit.converged; ++i) {
    const RobustTerms terms = evaluate_at(problem, loss, residuals / fit.scale);
    z -= fit.scale * Cholesky(weighted_information(problem, terms)).solve(gradient(problem, terms));
    const VectorXd before = std::exchange(residuals, problem.b - problem.J * z);
    const double scale_before = std::exchange(fit.scale, uncentred_scale(residuals));
    const double moved = (residuals - before).lpNorm<Eigen::Infinity>();
    fit.converged = std::max(moved, std::abs(fit.scale - scale_before)) <= fit_tolerance * scale_before;
  }
  fit.coefficients = problem.theta(z);
  fit.converged = fit.converged || fit.scale == 0.0;
  fit.standard_error = standard_errors(problem, loss, residuals, fit.scale);
  return fit;
}

}  // namespace

RobustRegression huber_regression(const Transitions& transitions) {
  if (transitions.count() == 0) throw std::invalid_argument("a regression needs at least one transition");
  if (!transitions.finite()) throw std::invalid_argument("a regression needs finite transitions");
  const Decomposition design = decompose(transitions.regressors, excitation_tolerance);
  const std::vector<Index> unidentifiable = unidentifiable_columns(transitions.regressors, design);
  const Index q = transitions.regressors.cols(), n = transitions.increments.cols();
  RobustRegression result{MatrixXd(q, n), MatrixXd(q, n), VectorXd(n), true};
  for (Index i = 0; i < n; ++i) {
    const ResponseFit fit = fit_response(one_response(transitions, i), design);
    result.coefficients.col(i) = fit.coefficients;
    result.standard_error.col(i) = fit.standard_error;
    for (const Index j : unidentifiable) result.standard_error(j, i) = not_a_number;
    result.scale(i) = fit.scale;
    result.converged = result.converged && fit.converged;
  }
  return result;
}

Eigen::VectorXd robust_coefficients(const Transitions& transitions, const FitOptions& options) {
  const RobustLoss loss(options.loss, options.loss_scale);
  const Decomposition decomposition = decompose(transitions.regressors, excitation_tolerance);
  const double rms = std::sqrt(residuals(decomposition, transitions.increments).squaredNorm() /
                               static_cast<double>(transitions.count()));
  const double robust = robust_scale(transitions, decomposition)(0);
  Eigen::VectorXd sigma(1);
  sigma << std::max({std::isfinite(robust) ? robust : 0.0, least_share_of_rms * rms, least_normal_scale});
  const WhitenedProblem problem = whiten(transitions, decomposition, sigma, nullptr);
  const Minimum minimum = minimise(problem, loss, options.max_iterations);
  return minimum.status == FitStatus::failed ? Eigen::VectorXd() : problem.theta(minimum.z);
}

Eigen::VectorXd robust_or_least_squares(const Transitions& transitions, const FitOptions& options) {
  Eigen::VectorXd robust = robust_coefficients(transitions, options);
  if (robust.size() > 0 && robust.allFinite()) return robust;
  return solve(decompose(transitions.regressors, excitation_tolerance), transitions.increments);
}

}  // namespace modebank
