#include "ident/fit/robust_regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "ident/base/not_a_number.hpp"
#include "ident/fit/fit_window.hpp"
#include "ident/fit/scale.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double normal_third_quartile = 0.674489750196081743;  // Phi^-1(3/4)
constexpr double fit_tolerance = 1e-12;                         // of the scale; rounding is some decades below
constexpr int max_iterations = 1000;

double uncentred_scale(const VectorXd& residuals) { return median(residuals.cwiseAbs()) / normal_third_quartile; }

/// One response in the orthonormal coordinates U of its regressors.
struct ResponseFit {
  VectorXd z;          // r
  VectorXd residuals;  // N
  double scale = 0.0;
  bool converged = false;
};

/// (U' W U)^-1 U' W y: U is orthonormal, so that the normal equations lose nothing.
VectorXd weighted_solution(const MatrixXd& U, const VectorXd& weights, const VectorXd& y) {
  const MatrixXd normal = U.transpose() * weights.asDiagonal() * U;
  return normal.llt().solve(U.transpose() * weights.cwiseProduct(y));
}

ResponseFit fit_response(const MatrixXd& U, const VectorXd& y, double k) {
  ResponseFit fit;
  fit.z = U.transpose() * y;
  fit.residuals = y - U * fit.z;
  fit.scale = uncentred_scale(fit.residuals);
  for (int i = 0; i < max_iterations && !fit.converged; ++i) {
    if (fit.scale == 0.0) {
      fit.converged = true;
      break;
    }
    const VectorXd weights = (k * fit.scale / fit.residuals.array().abs()).min(1.0);
    const VectorXd before = fit.residuals;
    const double scale_before = fit.scale;
    fit.z = weighted_solution(U, weights, y);
    fit.residuals = y - U * fit.z;
    fit.scale = uncentred_scale(fit.residuals);
    const double moved = (fit.residuals - before).lpNorm<Eigen::Infinity>();
    fit.converged = std::max(moved, std::abs(fit.scale - scale_before)) <= fit_tolerance * scale_before;
  }
  return fit;
}

/// Huber (1981), eq. 7.6.7: K^2 scale^2 [sum psi^2 / (N - q)] / [mean psi']^2, to be multiplied by (X'X)^-1.
double variance_factor(const ResponseFit& fit, double k, Index q) {
  const double N = static_cast<double>(fit.residuals.size()), spare = N - static_cast<double>(q);
  if (fit.scale == 0.0) return 0.0;
  if (spare <= 0.0) return not_a_number;
  const Eigen::ArrayXd standardised = fit.residuals.array() / fit.scale;
  const double psi_squared = standardised.min(k).max(-k).square().sum();
  const double inside = static_cast<double>((standardised.abs() <= k).count()) / N;
  const double K = 1.0 + static_cast<double>(q) / N * (1.0 - inside) / inside;
  return K * K * fit.scale * fit.scale * (psi_squared / spare) / (inside * inside);
}

/// Diagonal of (X'X)^-1 = basis basis', NaN when the rank is deficient.
VectorXd unscaled_variance(const Decomposition& design) {
  const Index q = design.basis.rows();
  if (design.rank() < q) return VectorXd::Constant(q, not_a_number);
  return design.basis.rowwise().squaredNorm();
}

}  // namespace

RobustRegression huber_regression(const Transitions& transitions) {
  if (transitions.count() == 0) throw std::invalid_argument("a regression needs at least one transition");
  if (!transitions.finite()) throw std::invalid_argument("a regression needs finite transitions");
  const Decomposition design = decompose(transitions.regressors, excitation_tolerance);
  const VectorXd variance = unscaled_variance(design);
  const double k = default_loss_scale(Loss::huber);
  const Index q = transitions.regressors.cols(), n = transitions.increments.cols();
  RobustRegression result{MatrixXd(q, n), MatrixXd(q, n), VectorXd(n), true};
  for (Index i = 0; i < n; ++i) {
    const ResponseFit fit = fit_response(design.U, transitions.increments.col(i), k);
    result.coefficients.col(i) = design.basis * fit.z;
    result.standard_error.col(i) = (variance_factor(fit, k, q) * variance).cwiseSqrt();
    result.scale(i) = fit.scale;
    result.converged = result.converged && fit.converged;
  }
  return result;
}

}  // namespace modebank
