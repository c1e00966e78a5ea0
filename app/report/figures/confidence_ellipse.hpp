#pragma once

#include <Eigen/Core>

namespace modebank {

/// Boundary of the region that holds the share `level` of N(mean, covariance): 2 x `points`, counter-clockwise, the
/// last point the first again. The squared radius is chi-square's quantile with two degrees of freedom, -2 ln(1 -
/// level). Negative eigenvalues count as zero. Throws std::invalid_argument for a level outside (0, 1) or fewer than 2
/// points.
Eigen::Matrix2Xd confidence_ellipse(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance, double level,
                                    Eigen::Index points);

}  // namespace modebank
