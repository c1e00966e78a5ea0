// Starts, moves away from poor optima, and matching of components.
#include "mixture/detail/starts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "mixture/assignment.hpp"
#include "mixture/detail/cloud.hpp"
#include "mixture/detail/split_merge.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

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
  EXPECT_NEAR(start.covariances[static_cast<std::size_t>(low)](0, 0), (2.0 + 3.0 * 14.0 / 6.0) / 5.0, 1e-14);
  EXPECT_NEAR(start.covariances[static_cast<std::size_t>(1 - low)](0, 0), (12.0 + 3.0 * 14.0 / 6.0) / 7.0, 1e-14);
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

TEST(SplitAndMerge, TheExpectedBestMoveIsTheRightOne) {
  const Eigen::MatrixXd points = draw(six_clusters(), 600, 4);
  const GaussianMixture stuck = fit_em(points, poor_start(), EmOptions{}).mixture;
  const std::vector<SplitMergeMove> moves = split_merge_moves(stuck, points, EmOptions{}, 3);
  ASSERT_FALSE(moves.empty());
  EXPECT_GT(moves[0].gain, 0.0);
  EXPECT_NEAR((stuck.means.col(moves[0].merged) - stuck.means.col(moves[0].absorbed)).norm(), 0.0, 2.0);
  const GaussianMixture after = apply(moves[0], stuck);
  EXPECT_NEAR(after.weights.sum(), 1.0, 1e-12);
  EXPECT_GT(log_density(after, points).sum(), log_density(stuck, points).sum());
}

/// Only `most` of the K^3 / 2 moves may be stored. With 500 components, all moves would not fit into memory.
TEST(SplitAndMerge, TheFewBestMovesAreTheBestOfAll) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd points = Eigen::MatrixXd::NullaryExpr(2, 300, [&] { return normal(generator); });
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(6, 1.0 / 6.0);
  mixture.means = points.leftCols(6);
  mixture.covariances.assign(6, 0.3 * Eigen::MatrixXd::Identity(2, 2));
  const std::vector<SplitMergeMove> all = split_merge_moves(mixture, points, EmOptions{}, 1000);
  ASSERT_GE(all.size(), 30u) << "10 merges of the other five for every component that can be split";
  for (std::size_t most : {std::size_t{1}, std::size_t{5}, std::size_t{20}}) {
    const std::vector<SplitMergeMove> few = split_merge_moves(mixture, points, EmOptions{}, most);
    ASSERT_EQ(few.size(), most);
    for (std::size_t i = 0; i < most; ++i) {
      EXPECT_EQ(few[i].gain, all[i].gain);
      EXPECT_EQ(few[i].split, all[i].split);
      EXPECT_EQ(few[i].merged, all[i].merged);
      EXPECT_EQ(few[i].absorbed, all[i].absorbed);
    }
  }
}

TEST(Assignment, AgreesWithAllPermutations) {
  std::mt19937_64 generator(1);
  for (Index size = 1; size <= 6; ++size)
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::MatrixXd values = Eigen::MatrixXd::NullaryExpr(
          size, size, [&]() { return static_cast<double>(generator() % 1000) / 100.0 - 5.0; });
      std::vector<Index> order(static_cast<std::size_t>(size));
      std::iota(order.begin(), order.end(), Index{0});
      const auto total = [&](const std::vector<Index>& columns) {
        double sum = 0.0;
        for (Index i = 0; i < size; ++i) sum += values(i, columns[static_cast<std::size_t>(i)]);
        return sum;
      };
      double best = -1e300;
      do best = std::max(best, total(order));
      while (std::next_permutation(order.begin(), order.end()));
      std::vector<Index> found = best_assignment(values);
      EXPECT_NEAR(total(found), best, 1e-9);
      std::sort(found.begin(), found.end());
      EXPECT_TRUE(std::is_permutation(found.begin(), found.end(), order.begin()));
    }
}

}  // namespace
}  // namespace modebank::test
