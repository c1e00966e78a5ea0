#pragma once

#include <Eigen/Core>

#include "ident/fit_window.hpp"
#include "ident/model_residuals.hpp"
#include "ident/robust_loss.hpp"

namespace modebank {

/// The general door: any MotionModel, fitted by Ceres with automatic derivatives.

/// How a minimum is searched: by Ceres' trust region and then Newton's steps, or by Newton's steps at once, with Ceres
/// where they fail to get to a stationary point. The latter is several times as fast, because a call of Ceres costs
/// more than a window's arithmetic; audits compare the two.
struct ModelSearch {
  int iterations = 100;
  bool newton_first = false;
};

/// What all windows of one fit have in common. Immutable, shared by threads.
struct ModelEstimator {
  RobustLoss loss;
  double consistency = 1.0;  ///< gaussian_consistency of the loss
  CovarianceKind covariance = CovarianceKind::model;
  ModelSearch search;
};

ModelEstimator make_model_estimator(const MotionModel& model, const FitOptions& options);

/// Unknowns of ModelResiduals at the end of a search, and how it ended: converged, iteration_limit or failed.
struct ModelMinimum {
  Eigen::VectorXd unknowns;
  FitStatus status = FitStatus::failed;
  double cost = 0.0;  ///< the objective there
};

/// Minimises 1/2 sum rho(|r_k / sigma|^2) + 1/2 |(theta - m) / sd|^2 within the parameters' bounds from `start`
/// (unknowns), by `search`. Newton's steps (NewtonSearch) end where the gradient, but for parameters that a bound
/// holds, is below 1e-10 of |psi|. `sigma`: n positive entries; `prior` may be null. Non-convex losses start from the
/// Huber optimum, and models that are not linear near the lower of two: from `start`, and from their least squares.
ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, const ModelSearch& search, const Eigen::VectorXd& start);

/// fit_window for any model: the fields of LocalModel have the meaning they have there, with the predictions'
/// derivatives by theta in the place of the regressors, taken at the solution. Their rank and condition are those of
/// all unknowns (for simulations the first state is one of them). With p parameters for n states the residuals lose p /
/// n degrees of freedom per state (for simulations (p + n) / n).
LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& sigma_floor, const ParameterPrior* prior, const Eigen::VectorXd& start);

}  // namespace modebank
