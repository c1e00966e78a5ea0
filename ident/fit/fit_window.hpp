#pragma once

#include <Eigen/Core>

#include "ident/data/trajectory.hpp"
#include "ident/fit/loss.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"
#include "ident/fit/scale.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Fits one window as a robust Ceres problem. The residual is r_k = (x[k+1] - x[k] - [A B c] phi_k) / sigma, with one
/// loss per sample on |r_k|^2 over its n states. Residuals other than outliers are assumed independent, with standard
/// deviation `sigma` (n entries, the state's unit). `prior` may be null. Transitions with a NaN or infinity are
/// ignored; L is the number of the other transitions. Rank deficiency is a status instead of an exception, and takes
/// precedence over iteration_limit. The status is `failed` (theta NaN) if no transition remains or numbers overflow.
///
/// noise_variance: sigma^2 sum w_k r_k^2 / [(L - rank) kappa] with the robust weight w_k = rho' and the rank of one
/// state's regressors. kappa = E[w z^2] for Gaussian z makes it consistent for the variance of Gaussian noise. For L <=
/// q: sum of squared residuals about the posterior / L. The lower bound is the square of `sigma_floor` (n entries, or
/// empty without a bound). It also bounds the residual variance of the `model` covariance. Throws std::invalid_argument
/// for a range outside the run, and for invalid sizes or signs.
LocalModel fit_window(const Trajectory& run, Index start, const LinearStructure& structure, const FitOptions& options,
                      const Eigen::VectorXd& sigma, const ParameterPrior* prior,
                      const Eigen::VectorXd& sigma_floor = {});

/// Data shared by all windows of one fit. Immutable, shared by threads.
struct Estimator {
  LinearStructure structure;
  RobustLoss loss;
  double consistency = 1.0;  ///< result of `gaussian_consistency` for the loss
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
};

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options);

/// The fit behind fit_window, for transitions that are already stacked and decomposed (with excitation_tolerance).
LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

/// Theta of fit_transitions, without its uncertainty; NaN if the fit failed.
Eigen::VectorXd fit_theta(const Transitions& transitions, const Decomposition& decomposition,
                          const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

}  // namespace modebank
