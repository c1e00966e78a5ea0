#pragma once

#include <Eigen/Core>

#include "ident/fit/loss.hpp"
#include "ident/fit/whitened_problem.hpp"

namespace modebank {

/// Residuals of a whitened problem at z, and the derivatives of the loss. psi_k = weight_k r_k is the influence of
/// sample k (Huber 1981).
struct RobustTerms {
  Eigen::VectorXd residual;   ///< b - J z, all rows
  Eigen::VectorXd weight;     ///< L, rho'(|r_k|^2)
  Eigen::VectorXd curvature;  ///< L, rho''(|r_k|^2)

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
/// RobustTerms for given residuals (all rows).
RobustTerms evaluate_at(const WhitenedProblem& problem, const RobustLoss& loss, Eigen::VectorXd residual);

/// The objective 1/2 sum rho(|r_k|^2) + 1/2 |prior rows|^2.
double half_cost(const WhitenedProblem& problem, const RobustLoss& loss, const RobustTerms& terms);
/// Gradient of half_cost with respect to z.
Eigen::VectorXd gradient(const WhitenedProblem& problem, const RobustTerms& terms);
/// Exact second derivative of half_cost.
Eigen::MatrixXd hessian(const WhitenedProblem& problem, const RobustTerms& terms);
/// The second derivative without rho'', as in iteratively reweighted least squares; never indefinite.
Eigen::MatrixXd weighted_information(const WhitenedProblem& problem, const RobustTerms& terms);

/// Distance from a minimum, without units: the norm of the gradient divided by the norm of psi and the prior's rows.
/// (The gradient is a projection of psi and these rows.) If |psi| is below 1e-5 |b|, the gradient is a rounding error
/// and is divided by 1e-5 |b| instead. (Karush-Kuhn-Tucker condition without bounds.)
double scaled_gradient(const WhitenedProblem& problem, const RobustTerms& terms);

/// The minimiser and the status of the search: converged, iteration_limit or failed.
struct Minimum {
  Eigen::VectorXd z;
  FitStatus status = FitStatus::failed;
};

/// Defines the fit of a linear window. Also solves it if the batch solver does not. The search starts from the
/// least-squares solution; for non-convex losses it starts from the Huber optimum. Ceres' trust region search comes
/// first, with one residual block and loss per sample. It ends when the relative cost change is below 1e-4. Newton
/// steps with the exact second derivative follow, to a scaled gradient of stationary_gradient. They are needed because
/// Ceres drops a negative rho'' and then converges only linearly. Deterministic, without output.
Minimum minimise(const WhitenedProblem& problem, const RobustLoss& loss, int max_iterations);

}  // namespace modebank
