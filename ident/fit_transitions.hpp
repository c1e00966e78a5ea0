#pragma once

#include <Eigen/Core>

#include "ident/fit_window.hpp"
#include "ident/regression.hpp"
#include "ident/robust_loss.hpp"

namespace modebank {

/// What all windows of one fit have in common. Immutable, shared by threads.
struct Estimator {
  LinearStructure structure;
  RobustLoss loss;
  double consistency = 1.0;  ///< gaussian_consistency of the loss
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
};

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options);

/// Residual standard deviations and what no estimate of them may fall below, n each.
struct NoiseScale {
  Eigen::VectorXd sigma;
  Eigen::VectorXd floor;
};

/// The fit behind fit_window, on transitions that are already stacked and decomposed (at excitation_tolerance).
LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

/// theta of fit_transitions alone, without its uncertainty; NaN when the fit failed.
Eigen::VectorXd fit_theta(const Transitions& transitions, const Decomposition& decomposition,
                          const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

/// The outcome for data that are not finite: everything NaN, rank 0.
LocalModel failed_fit(const LinearStructure& structure);

}  // namespace modebank
