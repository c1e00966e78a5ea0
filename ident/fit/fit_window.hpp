#pragma once

#include <Eigen/Core>

#include "ident/data/trajectory.hpp"
#include "ident/fit/loss.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"
#include "ident/fit/scale.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// Fits one window as a robust Ceres problem: residual r_k = (x[k+1] - x[k] - [A B c] phi_k) / sigma, one loss per
/// sample on |r_k|^2 over its n states. Assumes independent residuals of standard deviation `sigma` (n entries, the
/// state's unit) apart from outliers. `prior` may be null. Rank deficiency is a status of the result, never an
/// exception, and takes precedence over iteration_limit. Transitions that hold a NaN or infinity are left out, L counts
/// the others. Status failed (theta NaN): no transition is left, or numbers overflow.
///
/// Sample weights w_k (Trajectory::weight) multiply the losses: the fit minimises sum w_k rho(|r_k|^2), w_k divided by
/// their mean over the window, so that a common factor changes nothing, not even against the prior. Least squares: the
/// noise variance of transition k is taken as noise_variance / w_k, as statsmodels' WLS does. rank and condition are
/// those of the regressors times sqrt(w_k), robust_scale weighs its medians.
///
/// noise_variance: sigma^2 sum w_k r_k^2 / [(L - rank) kappa], w_k = rho' the robust weight and kappa = E[w z^2] for
/// Gaussian z, which makes it consistent for the variance of Gaussian noise (rank: of one state's regressors). Not
/// above L = q: sum of squared residuals about the posterior / L. Never below the square of `sigma_floor` (n entries,
/// or empty: none), nor is the residual variance of the `model` covariance. Throws std::invalid_argument for a range
/// outside the run or sizes and signs that do not fit.
LocalModel fit_window(const Trajectory& run, Index start, const LinearStructure& structure, const FitOptions& options,
                      const Eigen::VectorXd& sigma, const ParameterPrior* prior,
                      const Eigen::VectorXd& sigma_floor = {});

/// What all windows of one fit have in common. Immutable, shared by threads.
struct Estimator {
  LinearStructure structure;
  RobustLoss loss;
  double consistency = 1.0;  ///< gaussian_consistency of the loss
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
};

Estimator make_estimator(const LinearStructure& structure, const FitOptions& options);

/// The fit behind fit_window, on transitions that are already stacked and decomposed (at excitation_tolerance).
LocalModel fit_transitions(const Transitions& transitions, const Decomposition& decomposition,
                           const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

/// theta of fit_transitions alone, without its uncertainty; NaN when the fit failed.
Eigen::VectorXd fit_theta(const Transitions& transitions, const Decomposition& decomposition,
                          const Estimator& estimator, const NoiseScale& scale, const ParameterPrior* prior);

}  // namespace modebank
