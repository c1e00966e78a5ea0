#include "app/report/figures/confidence_ellipse.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "ident/base/linalg.hpp"

namespace modebank {

Eigen::Matrix2Xd confidence_ellipse(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance, double level,
                                    Eigen::Index points) {
  if (!(level > 0.0 && level < 1.0)) throw std::invalid_argument("confidence_ellipse: level must be in (0, 1)");
  if (points < 2) throw std::invalid_argument("confidence_ellipse: at least 2 points");
  const SymmetricEigen eigen = symmetric_eigen(covariance);
  const Eigen::Vector2d axes = (-2.0 * std::log1p(-level) * eigen.values.array().max(0.0)).sqrt();
  // A rotation, so that the boundary runs counter-clockwise.
  Eigen::Matrix2d rotation = eigen.vectors;
  if (rotation.determinant() < 0.0) rotation.col(1) *= -1.0;
  const Eigen::ArrayXd angle = Eigen::ArrayXd::LinSpaced(points, 0.0, 2.0 * std::numbers::pi);
  Eigen::Matrix2Xd circle(2, points);
  circle.row(0) = axes(0) * angle.cos().matrix().transpose();
  circle.row(1) = axes(1) * angle.sin().matrix().transpose();
  circle.col(points - 1) = circle.col(0);
  return (rotation * circle).colwise() + mean;
}

}  // namespace modebank
