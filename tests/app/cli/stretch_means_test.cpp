#include "app/text/stretch_means.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace modebank::test {
namespace {

TEST(StretchMeans, AreMeansOfEqualParts) {
  Eigen::MatrixXd rows(2, 6);
  rows << 1, 3, 5, 7, 9, 11, 0, 0, 0, 1, 1, 1;
  Eigen::MatrixXd expected(2, 3);
  expected << 2, 6, 10, 0, 0.5, 1;
  EXPECT_EQ(stretch_means(rows, 3), expected);
  EXPECT_EQ(stretch_means(rows, 100), rows);
}

/// Parts of unequal length cover every column once. So the mean of the parts, weighted by their lengths, is the mean of
/// all columns.
TEST(StretchMeans, CoverEveryColumnOnce) {
  const Eigen::MatrixXd rows = Eigen::RowVectorXd::LinSpaced(17, 0.0, 16.0);
  const Eigen::MatrixXd means = stretch_means(rows, 5);
  double sum = 0.0;
  for (Eigen::Index i = 0; i < 5; ++i) sum += means(0, i) * static_cast<double>((i + 1) * 17 / 5 - i * 17 / 5);
  EXPECT_NEAR(sum, rows.sum(), 1e-12);
}

TEST(StretchMeans, LeaveOutWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd rows(1, 4);
  rows << nan, 4, nan, nan;
  const Eigen::MatrixXd means = stretch_means(rows, 2);
  EXPECT_EQ(means(0, 0), 4.0);
  EXPECT_TRUE(std::isnan(means(0, 1)));
  EXPECT_EQ(stretch_means(Eigen::MatrixXd(2, 0), 3).cols(), 0);
  EXPECT_THROW(stretch_means(rows, 0), std::invalid_argument);
}

}  // namespace
}  // namespace modebank::test
