// Data for drawings of long series and of many runs.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "app/report/page/bucket_extremes.hpp"
#include "app/report/page/residual_pool.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank {
namespace {

const double nan_value = std::nan("");

TEST(BucketExtremes, KeepEveryExtremeAndLeaveOutWhatIsMissing) {
  Eigen::VectorXd values(8);
  values << 1, 5, -3, nan_value, nan_value, nan_value, 2, nan_value;
  const BucketExtremes extremes = bucket_extremes(values, 3);
  ASSERT_EQ(extremes.low.size(), 3);
  EXPECT_EQ(extremes.low(0), -3);
  EXPECT_EQ(extremes.high(0), 5);
  EXPECT_TRUE(std::isnan(extremes.low(1)) && std::isnan(extremes.high(1)));
  EXPECT_EQ(extremes.low(2), 2);  // the last bucket has two values
  EXPECT_EQ(extremes.high(2), 2);
  const Eigen::VectorXd means = bucket_means(values, 3);
  EXPECT_EQ(means(0), 1);
  EXPECT_TRUE(std::isnan(means(1)));
  EXPECT_EQ(means(2), 2);
  EXPECT_EQ(bucket_extremes(Eigen::VectorXd(), 4).low.size(), 0);
  EXPECT_THROW(bucket_extremes(values, 0), std::invalid_argument);
}

/// Buckets of buckets equal larger buckets, so a coarse level shows the same extremes as a fine level.
TEST(BucketExtremes, LevelsAgree) {
  std::mt19937_64 generator(7);
  boost::random::normal_distribution<double> normal;
  Eigen::VectorXd values(1000);
  for (double& value : values) value = normal(generator);
  const BucketExtremes fine = bucket_extremes(values, 4), coarse = bucket_extremes(values, 32);
  EXPECT_EQ(bucket_extremes(fine.low, 8).low, coarse.low);
  EXPECT_EQ(bucket_extremes(fine.high, 8).high, coarse.high);
  EXPECT_EQ(coarse.low.minCoeff(), values.minCoeff());
  EXPECT_EQ(coarse.high.maxCoeff(), values.maxCoeff());
}

ResidualTests tests_of(Index samples, std::vector<double> autocorrelation, double band) {
  ResidualTests tests;
  tests.samples = samples;
  tests.autocorrelation =
      Eigen::Map<Eigen::RowVectorXd>(autocorrelation.data(), static_cast<Index>(autocorrelation.size()));
  tests.autocorrelation_band = band;
  return tests;
}

TEST(ResidualPool, MeanBySamplesOverTheRunsThatHaveTheLag) {
  const ResidualTests pooled =
      pool_autocorrelations({tests_of(100, {1, 0.2, 0.4}, 0.25), tests_of(300, {1, 0.6}, 2.5 / std::sqrt(300.0)),
                             tests_of(50, {1, nan_value}, 0.1)});
  EXPECT_EQ(pooled.samples, 400);
  ASSERT_EQ(pooled.autocorrelation.cols(), 3);
  EXPECT_DOUBLE_EQ(pooled.autocorrelation(0, 1), 0.5);
  EXPECT_DOUBLE_EQ(pooled.autocorrelation(0, 2), 0.4);
  EXPECT_NEAR(pooled.autocorrelation_band, 2.5 / 20, 1e-15);  // z / sqrt(400)
  EXPECT_EQ(pool_autocorrelations({}).autocorrelation.size(), 0);
  EXPECT_TRUE(std::isnan(pool_autocorrelations({}).autocorrelation_band));
}

}  // namespace
}  // namespace modebank
