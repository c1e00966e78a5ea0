#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/data/window.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"
#include "modebank/ident/options.hpp"

namespace modebank {

/// The fit of one window: estimate, covariance and status.
struct LocalModel {
  Eigen::VectorXd theta;           ///< p
  Eigen::MatrixXd covariance;      ///< p x p, covariance of theta; NaN if rank deficient without a prior
  Eigen::VectorXd noise_variance;  ///< n, variance of the one-step residuals [state unit^2]
  double condition = 0.0;  ///< ratio of singular values of the column-scaled regressor matrix, before weights and prior
  Index rank = 0;          ///< rank of theta: n times the rank of the regressors at relative tolerance 1e-6
  Eigen::VectorXd information;   ///< p, 1 - posterior variance / prior variance; NaN without a prior
  double inlier_fraction = 0.0;  ///< share of samples that keep at least half of their least-squares weight
  FitStatus status = FitStatus::failed;
  Eigen::VectorXd r_squared;  ///< n; defined in ident/fit/describe.hpp; empty if it was not computed
  Index transitions = 0;      ///< L, transitions that entered the fit: the finite ones

  /// n, information of the data (curvature of the loss over sigma^2), in units of the information in `covariance`. With
  /// this number the prior can be removed from the estimate. NaN without a prior and for a sandwich covariance.
  Eigen::VectorXd weighed_information;
};

/// The global model: ordinary least squares over all training transitions.
struct GlobalModel {
  Eigen::VectorXd theta;                ///< p
  Eigen::MatrixXd covariance;           ///< p x p, residual covariance / (N - q) (x) (X'X)^-1
  Eigen::MatrixXd residual_covariance;  ///< n x n, residual covariance with divisor N
  Index transitions = 0;                ///< N
  Eigen::VectorXd noise_variance() const { return residual_covariance.diagonal(); }
};

/// The fits of all windows, one column per window (M columns). Even a million windows need only a few arrays.
struct WindowFits {
  std::string model = "linear";  ///< linear, varx, or the name of a motion model

  /// Structure of the linear model. For a motion model, the structure of its linearisations x[k+1] = x + A x + B u + c.
  LinearStructure structure;
  std::vector<ModelParameter> model_parameters;  ///< parameters of a motion model; empty for linear models
  Index length = 0;                              ///< transitions per window
  Index step = 1;                                ///< transitions between window starts
  Loss loss = Loss::huber;
  std::vector<Window> windows;          ///< M
  Eigen::MatrixXd parameters;           ///< p x M
  Eigen::MatrixXd covariance;           ///< covariances of theta, p*p x M; each column is a p x p matrix
  Eigen::MatrixXd noise_variance;       ///< n x M, variances of the one-step residuals
  Eigen::VectorXd condition;            ///< M
  Eigen::VectorXi rank;                 ///< M
  Eigen::MatrixXd information;          ///< p x M
  Eigen::VectorXd inlier_fraction;      ///< M
  Eigen::VectorXi status;               ///< M, FitStatus
  Eigen::MatrixXd r_squared;            ///< n x M
  Eigen::VectorXi transitions;          ///< M
  Eigen::MatrixXd weighed_information;  ///< n x M; defined in LocalModel
  Eigen::VectorXd prior_sd;             ///< p, standard deviations of the prior; empty without a prior
  GlobalModel global;
  std::vector<char> by_batch;  ///< M, 1 if the batch solver solved the window, else 0; not archived

  Index count() const { return static_cast<Index>(windows.size()); }
  Index parameter_count() const;
  std::vector<std::string> parameter_names() const;
  void resize(Index windows_count);
  void set(Index i, const LocalModel& fit);
  LocalModel at(Index i) const;
  /// Standard errors (p x M), and t values theta / standard error, derived from parameters and covariance.
  Eigen::MatrixXd standard_errors() const;
  Eigen::MatrixXd t_values() const;
};

}  // namespace modebank
