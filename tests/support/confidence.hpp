#pragma once

#include <Eigen/Core>

namespace modebank::test {

/// What a window's fit says about its p parameters.
struct FittedTheta {
  Eigen::VectorXd theta;
  Eigen::MatrixXd covariance;
  Eigen::VectorXd information;   ///< p, share of each parameter that the data determine; NaN without a prior
  Eigen::Index states = 1;       ///< n; each state has p / n of the parameters
  Eigen::Index transitions = 0;  ///< L
};

/// Degrees of freedom nu of the noise variance in the covariance. Regions are (theta - truth)' covariance^-1 (theta -
/// truth) <= p F_level(p, nu). Without a prior nu = L - p, at least 1. With a prior, only f = sum of `information` of
/// the p directions depend on the estimated noise variance. The other directions depend on the prior's variance, which
/// is known. Then nu = 2 + (L - p - 2) p / f. The statistic then has the right mean if the truth is drawn from the
/// prior. For L <= q, nu is infinite: the noise is known, and regions are chi-square.
double region_degrees_of_freedom(const FittedTheta& fit);

/// The ellipsoid that contains the true theta with probability `level`. With a sandwich covariance of several states,
/// it is too small unless L is large compared with p (docs/explanation/windows.md). In that case use the parameters
/// of each state separately.
struct ConfidenceRegion {
  Eigen::VectorXd center;      ///< p, theta
  Eigen::MatrixXd covariance;  ///< p x p
  double limit = 0.0;          ///< largest squared Mahalanobis distance in the region: p F(p, nu), or chi-square(p);
                               ///< NaN if it is undefined

  /// Returns false if the region is undefined.
  bool contains(const Eigen::VectorXd& theta) const;
};

/// Throws std::invalid_argument unless 0 < level < 1.
ConfidenceRegion confidence_region(const FittedTheta& fit, double level = 0.95);

}  // namespace modebank::test
