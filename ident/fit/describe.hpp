#pragma once

#include "ident/fit/minimise.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/scale.hpp"
#include "ident/fit/whitened_problem.hpp"

namespace modebank {

/// A window's problem at its optimum, of a linear or a motion model, and what its description needs.
struct SolvedWindow {
  const WhitenedProblem& problem;
  const RobustTerms& terms;
  const Transitions& transitions;  ///< only the increments are used
  const RobustLoss& loss;
  double consistency = 1.0;  ///< gaussian_consistency of the loss
  CovarianceKind covariance = CovarianceKind::model;
  const NoiseScale& scale;
  const ParameterPrior* prior = nullptr;
  double unknowns_per_state = 0.0;  ///< q of a linear model
  double rank_per_state = 0.0;
};

/// Everything of LocalModel but condition, rank and status, as fit_window states it; theta is that of `terms`' optimum
/// given as `theta`, whose entries are the first of the problem's.
LocalModel describe_fit(const SolvedWindow& solved, const Eigen::VectorXd& theta);

/// How much of a window a fit explains, from its problem and the terms at the optimum. omega_k is the robust weight of
/// sample k, w_k its sample weight, d_k its increment, e_k its residual, both in the state's unit.

/// R^2 of the increments x[k+1] - x[k], not of the states (which a model that only repeats x[k] explains nearly fully):
/// 1 - sum omega w e^2 / sum omega w (d - mean)^2, mean = sum omega w d / sum omega w; n entries. Weighting both sums
/// makes it that of the samples which the fit follows (Willett & Singer 1988, The American Statistician 42); trivial
/// loss: the usual R^2 about the mean (statsmodels' 1 - ssr / centered_tss), also of weighted least squares. Without an
/// intercept, or with a prior, it may be negative. NaN for increments that do not vary.
Eigen::VectorXd r_squared(const Transitions& transitions, const WhitenedProblem& problem, const RobustTerms& terms,
                          const Eigen::VectorXd& sigma);

/// Akaike's criterion, lower is better; comparable between fits of the same samples with the same loss.
/// Trivial loss: L sum_i [log(2 pi sum_k w e_i^2 / L) + 1] - n sum log w + 2 (f + n): -2 log of the Gaussian likelihood
/// at its maximal noise variances (not below the floor), which count as n parameters.
/// Other losses: L n log(2 pi) + 2 L sum_i log sigma_i + sum w rho(|e / sigma|^2) - n sum log w + 2 (a f + n), where a
/// = sum w psi^2 / sum w psi' is the price of a parameter under rho (Ronchetti 1985, Statistics & Probability Letters
/// 3; Burman & Nolan 1995, Biometrika 82); NaN where psi' is not positive on average. It is the former one for rho(s) =
/// s. f = sum of the samples' leverages: p, or n times the rank, or with a prior the part of p that data determine
/// (Hastie & Tibshirani 1990).
double akaike_criterion(const WhitenedProblem& problem, const RobustTerms& terms, const RobustLoss& loss,
                        const NoiseScale& scale);

/// The outcome for data that are not finite or cannot be fitted: everything NaN, rank 0.
LocalModel failed_fit(Index parameters, Index states);

}  // namespace modebank
