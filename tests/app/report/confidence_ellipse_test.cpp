#include "app/report/figures/confidence_ellipse.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace modebank::test {
namespace {

/// Every point lies at chi-square's 95 % quantile with two degrees of freedom, 5.991 (any table).
TEST(ConfidenceEllipse, HasTheDistanceOfItsLevel) {
  Eigen::Matrix2d covariance;
  covariance << 4, 1.5, 1.5, 1;
  const Eigen::Vector2d mean(3, -2);
  const Eigen::Matrix2Xd points = confidence_ellipse(mean, covariance, 0.95, 33);
  EXPECT_EQ(points.col(0), points.col(32));
  double area = 0.0;
  for (Eigen::Index i = 0; i < 32; ++i) {
    const Eigen::Vector2d d = points.col(i) - mean, next = points.col(i + 1) - mean;
    EXPECT_NEAR(d.dot(covariance.inverse() * d), 5.991464547107979, 1e-12);
    area += 0.5 * (d.x() * next.y() - d.y() * next.x());
  }
  // A polygon of 32 sides covers this share of its circle; positive: counter-clockwise.
  const double polygon = std::sin(std::numbers::pi / 16) / (std::numbers::pi / 16);
  EXPECT_NEAR(area, polygon * std::numbers::pi * 5.991464547107979 * std::sqrt(covariance.determinant()), 1e-9);
}

TEST(ConfidenceEllipse, OfNoSpreadIsAPoint) {
  const Eigen::Matrix2Xd points = confidence_ellipse({1, 2}, Eigen::Matrix2d::Zero(), 0.5, 5);
  EXPECT_EQ(points, (Eigen::Matrix2Xd(2, 5) << 1, 1, 1, 1, 1, 2, 2, 2, 2, 2).finished());
  EXPECT_THROW(confidence_ellipse({1, 2}, Eigen::Matrix2d::Identity(), 1.0, 5), std::invalid_argument);
}

}  // namespace
}  // namespace modebank::test
