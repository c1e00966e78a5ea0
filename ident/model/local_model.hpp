#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ident/data/window.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/motion_model.hpp"
#include "modebank/base/names.hpp"

namespace modebank {

/// How a window's fit ended. The values are those of /windows/status in the archive.
enum class FitStatus : int { converged = 0, iteration_limit = 1, rank_deficient = 2, failed = 3 };

/// Robust losses rho(s) of s = |r|^2 as Ceres defines them.
enum class Loss { trivial, huber, cauchy, softlone, tukey, arctan };

template <>
struct EnumNames<Loss> {
  static constexpr Names<6> values{"trivial", "huber", "cauchy", "softlone", "tukey", "arctan"};
};

/// What a model is compared with: each sample predicted from the measured one before (equation error), or the whole
/// window simulated from its first sample, which then is estimated, too (output error: Ljung 1999, section 3.2). The
/// first assumes process noise, the second measurement noise.
enum class ResidualKind { one_step, simulation };

template <>
struct EnumNames<ResidualKind> {
  static constexpr Names<2> values{"one-step", "simulation"};
};

/// Which covariance of theta is reported (method: Huber 1981 for `model`, HC3 for `sandwich`).
enum class CovarianceKind { model, sandwich };

template <>
struct EnumNames<CovarianceKind> {
  static constexpr Names<2> values{"model", "sandwich"};
};

/// The fit of one window: estimate, uncertainty and how it ended, always together.
struct LocalModel {
  Eigen::VectorXd theta;           ///< p
  Eigen::MatrixXd covariance;      ///< p x p of theta; NaN when rank deficient without a prior
  Eigen::VectorXd noise_variance;  ///< n, of the one-step residuals [state unit^2]
  double condition = 0.0;  ///< ratio of singular values of the column-scaled regressor matrix, before weights and prior
  Index rank = 0;          ///< of theta: n times the regressors' rank at relative tolerance 1e-6
  Eigen::VectorXd information;   ///< p, 1 - posterior variance / prior variance; NaN without a prior
  double inlier_fraction = 0.0;  ///< share of samples that keep at least half of their least-squares weight
  FitStatus status = FitStatus::failed;
  Eigen::VectorXd r_squared;  ///< n, see ident/fit/describe.hpp; empty: not computed
  double aic = 0.0;           ///< nat, see ident/fit/describe.hpp
  Index transitions = 0;      ///< L, those that entered the fit: finite and of positive weight
  bool solved = false;        ///< the search reached its tolerance (a deficient rank hides iteration_limit in `status`)
};

/// The global model: plain least squares over all training transitions.
struct GlobalModel {
  Eigen::VectorXd theta;                ///< p
  Eigen::MatrixXd covariance;           ///< p x p, residual covariance / (N - q) (x) (X'X)^-1
  Eigen::MatrixXd residual_covariance;  ///< n x n, population (divided by N)
  Index transitions = 0;                ///< N
  Eigen::VectorXd noise_variance() const { return residual_covariance.diagonal(); }
};

/// Who solved the windows to what tolerance, and how a random sample of the batch solver's answers compares with those
/// of Ceres alone, run on to tolerances of 1e-16: both judged by the objective and its gradient.
struct WindowAudit {
  /// Relative difference in cost, and gradient (scaled_gradient), above which an answer is no minimum.
  static constexpr double tolerance = 1e-9, gradient_tolerance = 1e-8;
  Index batch = 0;           ///< windows that the batch solver solved
  Index ceres = 0;           ///< windows solved as `ceres_method` says; those of neither are unsolved
  std::string batch_method;  ///< in words; empty without a batch solver
  std::string ceres_method;
  Index checked = 0;                  ///< windows of the batch solver solved again by Ceres alone
  double cost_difference = 0.0;       ///< largest relative difference in cost
  double gradient = 0.0;              ///< largest scaled gradient of the batch solver's answers
  double ceres_gradient = 0.0;        ///< largest scaled gradient of Ceres'
  double parameter_difference = 0.0;  ///< largest difference of a parameter in its standard errors: information only
  Index replaced = 0;  ///< checked windows whose cost or gradient was above tolerance: solved anew by `ceres_method`
  Index lower = 0;     ///< checked windows whose cost was below Ceres' by more (losses with several minima)
};

/// All windows' fits, one window per column (M columns), so a million windows are a handful of arrays.
struct WindowFits {
  std::string model = "linear";  ///< linear, varx, or the name of a motion model
  /// Of linear models. Of a motion model: that of its linearisations x[k+1] = x + A x + B u + c.
  LinearStructure structure;
  std::vector<ModelParameter> model_parameters;  ///< of a motion model; empty for linear ones
  ResidualKind residual = ResidualKind::one_step;
  Index length = 0;  ///< transitions per window
  Index step = 1;    ///< transitions between window starts
  Loss loss = Loss::huber;
  std::vector<Window> windows;      ///< M
  Eigen::MatrixXd parameters;       ///< p x M
  Eigen::MatrixXd covariance;       ///< p*p x M, each column a p x p matrix
  Eigen::MatrixXd noise_variance;   ///< n x M
  Eigen::VectorXd condition;        ///< M
  Eigen::VectorXi rank;             ///< M
  Eigen::MatrixXd information;      ///< p x M
  Eigen::VectorXd inlier_fraction;  ///< M
  Eigen::VectorXi status;           ///< M, FitStatus
  Eigen::MatrixXd r_squared;        ///< n x M
  Eigen::VectorXd aic;              ///< M
  Eigen::VectorXi transitions;      ///< M
  Eigen::VectorXd prior_sd;         ///< p, the prior's standard deviations; empty without a prior
  GlobalModel global;
  WindowAudit audit;

  Index count() const { return static_cast<Index>(windows.size()); }
  Index parameter_count() const;
  std::vector<std::string> parameter_names() const;
  void resize(Index windows_count);
  void set(Index i, const LocalModel& fit);
  LocalModel at(Index i) const;
  /// p x M standard errors and t values (theta / standard error), derived from parameters and covariance.
  Eigen::MatrixXd standard_errors() const;
  Eigen::MatrixXd t_values() const;
};

}  // namespace modebank
