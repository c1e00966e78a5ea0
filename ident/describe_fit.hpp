#pragma once

#include "ident/fit_transitions.hpp"
#include "ident/m_estimate.hpp"

namespace modebank {

/// A window's problem at its optimum, from either door, and what its description needs.
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

/// The outcome for data that are not finite or cannot be fitted: everything NaN, rank 0.
LocalModel failed_fit(Index parameters, Index states);

}  // namespace modebank
