#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/enum_names.hpp"
#include "ident/model.hpp"
#include "ident/window.hpp"

namespace modebank {

/// How a window's fit ended. The values are those of /windows/status in the archive.
enum class FitStatus : int { converged = 0, iteration_limit = 1, rank_deficient = 2, failed = 3 };

/// Robust losses rho(s) of s = |r|^2 as Ceres defines them.
enum class Loss { trivial, huber, cauchy, softlone, tukey, arctan };

template <>
struct EnumNames<Loss> {
  static constexpr Names<6> values{"trivial", "huber", "cauchy", "softlone", "tukey", "arctan"};
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
};

/// The global model: plain least squares over all training transitions.
struct GlobalModel {
  Eigen::VectorXd theta;                ///< p
  Eigen::MatrixXd covariance;           ///< p x p, residual covariance / (N - q) (x) (X'X)^-1
  Eigen::MatrixXd residual_covariance;  ///< n x n, population (divided by N)
  Index transitions = 0;                ///< N
  Eigen::VectorXd noise_variance() const { return residual_covariance.diagonal(); }
};

/// All windows' fits, one window per column (M columns), so a million windows are a handful of arrays.
struct WindowFits {
  LinearStructure structure;
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
  Eigen::VectorXd prior_sd;         ///< p, the prior's standard deviations; empty without a prior
  GlobalModel global;

  Index count() const { return static_cast<Index>(windows.size()); }
  Index parameter_count() const { return structure.parameters(); }
  void resize(Index windows_count);
  void set(Index i, const LocalModel& fit);
  LocalModel at(Index i) const;
};

}  // namespace modebank
