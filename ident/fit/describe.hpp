#pragma once

#include "ident/fit/minimise.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/scale.hpp"
#include "ident/fit/whitened_problem.hpp"

namespace modebank {

/// A window's problem at its optimum, for a linear model or a motion model, with the inputs of its description.
struct SolvedWindow {
  const WhitenedProblem& problem;
  const RobustTerms& terms;
  const Transitions& transitions;  ///< transitions of the window; only their increments are used
  double consistency = 1.0;        ///< result of `gaussian_consistency` for the loss
  CovarianceKind covariance = CovarianceKind::model;
  const NoiseScale& scale;
  const ParameterPrior* prior = nullptr;
  double unknowns_per_state = 0.0;  ///< number of unknowns per state: q for a linear model
  double rank_per_state = 0.0;
};

/// All fields of LocalModel except `condition`, `rank` and `status`, as defined at fit_window. `theta` is the optimum
/// at which `terms` were computed. The first entries of the problem are those of `theta`.
LocalModel describe_fit(const SolvedWindow& solved, const Eigen::VectorXd& theta);

/// Measures that show how well a fit explains a window, from its problem and the terms at the optimum. For sample k:
/// omega_k is the robust weight, d_k the increment and e_k the residual, both in the state's unit.

/// R^2 of the increments x[k+1] - x[k], n entries. (A model that only repeats x[k] would explain the states nearly
/// fully.) R^2 = 1 - sum omega e^2 / sum omega (d - mean)^2 with mean = sum omega d / sum omega. With weights
/// in both sums, R^2 describes the samples that the fit follows (Willett & Singer 1988, The American Statistician 42).
/// For a trivial loss R^2 is the usual R^2 about the mean (statsmodels' 1 - ssr / centered_tss). It may be negative
/// without an intercept or with a prior. NaN for constant increments.
Eigen::VectorXd r_squared(const Transitions& transitions, const WhitenedProblem& problem, const RobustTerms& terms,
                          const Eigen::VectorXd& sigma);

/// Result for data that are not finite or cannot be fitted: all NaN, rank 0.
LocalModel failed_fit(Index parameters, Index states);

}  // namespace modebank
