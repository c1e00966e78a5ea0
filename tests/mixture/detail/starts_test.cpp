// Starts, moves away from poor optima, and matching of components.
#include "mixture/detail/starts.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "mixture/detail/cloud.hpp"
#include "tests/mixture/mixture_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

/// Six clusters in a row, at two different distances. Random starts often put two centres in one cluster.
GaussianMixture six_clusters() {
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(6, 1.0 / 6.0);
  mixture.means.resize(2, 6);
  mixture.means << 0, 3, 30, 33, 60, 63, 0, 3, 0, 3, 0, 3;
  mixture.covariances.assign(6, 0.1 * Eigen::Matrix2d::Identity());
  return mixture;
}

TEST(Starts, RandomOnesFindSeparateClusters) {
  const Eigen::MatrixXd points = draw(six_clusters(), 600, 3);
  EmOptions options;
  options.restarts = 3;
  const double truth = fit_em(points, six_clusters(), options).log_likelihood;
  const EmResult fit = fit_em(points, 6, options, 1);
  EXPECT_NEAR(fit.log_likelihood, truth, 1e-3);
  EXPECT_EQ(fit.agreeing_restarts, 3);
}

/// Moments of clusters, computed one by one (within-cluster and pooled scatter).
TEST(Starts, ClustersMomentsAreDrawnTowardsThePooledOnes) {
  Eigen::MatrixXd points(1, 4);
  points << 0.0, 2.0, 100.0, 104.0;
  const Eigen::VectorXd weights = (Eigen::VectorXd(4) << 1.0, 1.0, 1.0, 3.0).finished();
  const PointBlocks blocks(PointSet(points, weights), FeatureScale::identity(1));
  std::mt19937_64 generator(1);
  GaussianMixture start;
  do start = random_start(blocks, 2, EmOptions{}, generator);
  while (std::abs(start.means(0) - start.means(1)) < 90.0);  // repeats until both centres lie in the same cluster
  const Index low = start.means(0) < 50.0 ? 0 : 1;
  EXPECT_NEAR(start.means(low), 1.0, 1e-14);
  EXPECT_NEAR(start.means(1 - low), 103.0, 1e-14);
  // The scatters are 2 and 12 with weights 2 and 4, pooled 14 / 6. The strength is (F + 1) times the mean weight 1.5.
  EXPECT_NEAR(start.covariances[low](0, 0), (2.0 + 3.0 * 14.0 / 6.0) / 5.0, 1e-14);
  EXPECT_NEAR(start.covariances[1 - low](0, 0), (12.0 + 3.0 * 14.0 / 6.0) / 7.0, 1e-14);
  EXPECT_NEAR(start.weights(low), 3.5 / 9.0, 1e-15);
}

TEST(Starts, PointsForStartsAreNotChosenFromAgain) {
  const Eigen::MatrixXd points = draw(six_clusters(), 200, 5);
  const PointBlocks blocks(PointSet(points), FeatureScale::identity(2));
  std::mt19937_64 generator(1);
  const PointBlocks chosen = blocks.for_starts(50, generator);
  EXPECT_EQ(chosen.count(), 50);
  EXPECT_THROW(chosen.for_starts(10, generator), std::logic_error);  // regression test; it once read freed memory
}

/// A start with two components in one cluster and one component for two clusters. EM alone does not leave it.
GaussianMixture poor_start() {
  GaussianMixture start = six_clusters();
  start.means.col(1) = start.means.col(0) + Eigen::Vector2d(0.2, 0.0);
  start.means.col(0).x() -= 0.2;
  start.means.col(2) << 1.5, 1.5;
  start.means.col(3) << 31.5, 1.5;
  start.covariances[2] = start.covariances[3] = 4.0 * Eigen::Matrix2d::Identity();
  start.means.col(0) << 60, 0;
  start.means.col(1) << 60.2, 0;
  return start;
}

TEST(SplitAndMerge, LeavesAPoorOptimum) {
  const Eigen::MatrixXd points = draw(six_clusters(), 600, 4);
  EmOptions options;
  options.restarts = 1;
  const double truth = fit_em(points, six_clusters(), options).log_likelihood;
  const double stuck = fit_em(points, poor_start(), options).log_likelihood;
  ASSERT_LT(stuck, truth - 100.0);
  const EmSweep sweep(points, options);
  const GaussianMixture start = poor_start();
  EXPECT_NEAR(sweep.fit(6, 1, &start).log_likelihood, truth, 1e-3);
  options.split_merge = 0;
  EXPECT_NEAR(EmSweep(points, options).fit(6, 1, &start).log_likelihood, stuck, 1e-3);
}

}  // namespace
}  // namespace modebank::test
