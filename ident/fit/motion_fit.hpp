#pragma once

#include <Eigen/Core>

#include "ident/fit/loss.hpp"
#include "ident/fit/motion_residuals.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"

namespace modebank {

/// What all windows of one fit of a motion model have in common. Immutable, shared by threads.
struct ModelEstimator {
  RobustLoss loss;
  double consistency = 1.0;  ///< gaussian_consistency of the loss
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
};

ModelEstimator make_model_estimator(const MotionModel& model, const FitOptions& options);

/// Unknowns of ModelResiduals at the end of a search, and how it ended: converged, iteration_limit or failed.
struct ModelMinimum {
  Eigen::VectorXd unknowns;
  FitStatus status = FitStatus::failed;
};

/// Minimises 1/2 sum w_k rho(|r_k / sigma|^2) + 1/2 |(theta - m) / sd|^2 within the parameters' bounds from `start`
/// (unknowns), w_k the sample weights of `residuals`: Ceres' trust region until the cost changes by less than a tenth,
/// then Newton's steps (NewtonSearch) until the gradient, but for parameters that a bound holds, is below
/// stationary_gradient of |psi|; where they do not get there, Ceres to a change of 1e-14 and Newton's steps again.
/// Ceres alone to 1e-14 takes 2.7 times as long on the Husky on ice (slip, 2,492 windows: 1.64 s against 0.61 s of
/// processor time) and leaves 996 windows at the limit of 100 steps. Non-convex losses start from the Huber optimum.
/// `sigma`: n positive entries; `prior` may be null.
ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, int max_iterations, const Eigen::VectorXd& start);

/// fit_window for any model: the fields of LocalModel have the meaning they have there, with the predictions'
/// derivatives by theta in the place of the regressors, taken at the solution. Their rank and condition are those of
/// all unknowns (for simulations the first state is one of them). With p parameters for n states the residuals lose p /
/// n degrees of freedom per state (for simulations (p + n) / n).
LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& sigma_floor, const ParameterPrior* prior, const Eigen::VectorXd& start);

}  // namespace modebank
