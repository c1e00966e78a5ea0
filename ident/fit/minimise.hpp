#pragma once

#include <Eigen/Core>

#include "ident/fit/loss.hpp"
#include "ident/fit/whitened_problem.hpp"

namespace modebank {

/// Residuals of a whitened problem at z and the loss' derivatives there. psi_k = weight_k r_k is the influence of
/// sample k (Huber 1981). Of a sample with weight w all are those of its rows, which carry sqrt(w): r_k is sqrt(w)
/// times the sample's residual.
struct RobustTerms {
  Eigen::VectorXd residual;   ///< all rows of b - J z
  Eigen::VectorXd weight;     ///< L, rho'(|r_k|^2 / w)
  Eigen::VectorXd curvature;  ///< L, rho''(|r_k|^2 / w) / w

  auto sample(Index k, Index states) const { return residual.segment(k * states, states); }
  /// Residuals of the samples, L x n.
  auto samples(Index states) const {
    using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return Eigen::Map<const Rows>(residual.data(), weight.size(), states);
  }
  /// d psi_k / d r_k = rho' I + 2 rho'' r r', n x n.
  Eigen::MatrixXd influence_slope(Index k, Index states) const;
};

RobustTerms evaluate(const WhitenedProblem& problem, const RobustLoss& loss, const Eigen::VectorXd& z);
/// The same at given residuals (all rows).
RobustTerms evaluate_at(const WhitenedProblem& problem, const RobustLoss& loss, Eigen::VectorXd residual);

/// The objective 1/2 sum w rho(|r_k|^2 / w) + 1/2 |prior rows|^2.
double half_cost(const WhitenedProblem& problem, const RobustLoss& loss, const RobustTerms& terms);
/// Its gradient in z.
Eigen::VectorXd gradient(const WhitenedProblem& problem, const RobustTerms& terms);
/// Its exact second derivative.
Eigen::MatrixXd hessian(const WhitenedProblem& problem, const RobustTerms& terms);
/// The second derivative without rho'', as iteratively reweighted least squares takes it: never indefinite.
Eigen::MatrixXd weighted_information(const WhitenedProblem& problem, const RobustTerms& terms);

/// How far from a minimum (the Karush-Kuhn-Tucker condition of a problem without bounds): the gradient's norm relative
/// to that of psi and the prior's rows, of which it is a projection, or to 1e-5 |b| where psi is smaller still and the
/// gradient rounding error. Free of units.
double scaled_gradient(const WhitenedProblem& problem, const RobustTerms& terms);

/// The minimiser, and how the search for it ended: converged, iteration_limit or failed.
struct Minimum {
  Eigen::VectorXd z;
  FitStatus status = FitStatus::failed;
};

/// THE definition of a linear window's fit, and what solves it where the batch solver does not: Ceres' trust region
/// search, one residual block and loss per sample, from the least-squares solution (non-convex losses: from the Huber
/// optimum) until the cost changes by less than 1e-4 of itself; then Newton steps with the exact second derivative to a
/// scaled gradient of stationary_gradient, because Ceres drops rho'' where it is negative and so gains only a constant
/// factor per step near the optimum. Deterministic and silent.
Minimum minimise(const WhitenedProblem& problem, const RobustLoss& loss, int max_iterations);

/// Ceres alone from the same start, at tolerances of 1e-16: what audits compare with.
Minimum minimise_by_ceres_alone(const WhitenedProblem& problem, const RobustLoss& loss);

}  // namespace modebank
