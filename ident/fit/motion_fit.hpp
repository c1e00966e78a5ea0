#pragma once

#include <Eigen/Core>

#include "ident/fit/loss.hpp"
#include "ident/fit/motion_residuals.hpp"
#include "ident/fit/options.hpp"
#include "ident/fit/prior.hpp"

namespace modebank {

/// The data shared by all windows of one motion-model fit. Immutable, shared by threads.
struct ModelEstimator {
  RobustLoss loss;
  double consistency = 1.0;  ///< result of `gaussian_consistency` for the loss
  CovarianceKind covariance = CovarianceKind::model;
  int max_iterations = 100;
};

ModelEstimator make_model_estimator(const MotionModel& model, const FitOptions& options);

/// theta at the end of a search, and its status: converged, iteration_limit or failed.
struct ModelMinimum {
  Eigen::VectorXd theta;
  FitStatus status = FitStatus::failed;
};

/// Minimises 1/2 sum w_k rho(|r_k / sigma|^2) + 1/2 |(theta - m) / sd|^2 by Ceres. The search begins at `start` and
/// stays within the bounds of the parameters. w_k are the weights of `residuals`, all 1 unless the loss is trivial. For
/// non-convex losses the search starts from the Huber optimum. `sigma` has n positive entries; `prior` may be null.
ModelMinimum minimise_model(const ModelResiduals& residuals, const Eigen::VectorXd& sigma, const RobustLoss& loss,
                            const ParameterPrior* prior, int max_iterations, const Eigen::VectorXd& start);

/// fit_window for any model; the fields of LocalModel have the same meaning. In place of regressors, this function uses
/// the derivatives of the predictions with respect to theta at the solution. Rank and condition are those of all
/// unknowns. With p parameters for n states, the residuals of each state lose p / n degrees of freedom.
LocalModel fit_model(const ModelResiduals& residuals, const ModelEstimator& estimator, const Eigen::VectorXd& sigma,
                     const Eigen::VectorXd& sigma_floor, const ParameterPrior* prior, const Eigen::VectorXd& start);

}  // namespace modebank
