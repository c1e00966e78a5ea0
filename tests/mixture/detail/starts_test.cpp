// Starts, moves out of poor optima, and matching of components.
#include "mixture/starts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "mixture/assignment.hpp"
#include "mixture/hierarchical.hpp"
#include "mixture/kmeans_kernels.hpp"
#include "mixture/point_blocks.hpp"
#include "mixture/split_merge.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

/// Six clusters in a row of two distances: k-means++ and random starts often put two centres in one of them.
GaussianMixture six_clusters() {
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(6, 1.0 / 6.0);
  mixture.means.resize(2, 6);
  mixture.means << 0, 3, 30, 33, 60, 63, 0, 3, 0, 3, 0, 3;
  mixture.covariances.assign(6, 0.1 * Eigen::Matrix2d::Identity());
  return mixture;
}

TEST(Agglomeration, FindsSeparateClusters) {
  const Eigen::MatrixXd points = draw(six_clusters(), 120, 1);
  const std::vector<int> labels = agglomerate(points).labels(6);
  const Eigen::MatrixXd memberships = responsibilities(six_clusters(), points);
  for (Index i = 0; i < 120; ++i)
    for (Index j = 0; j < i; ++j) {
      Index a = 0, b = 0;
      memberships.col(i).maxCoeff(&a);
      memberships.col(j).maxCoeff(&b);
      EXPECT_EQ(labels[static_cast<std::size_t>(i)] == labels[static_cast<std::size_t>(j)], a == b) << i << " " << j;
    }
}

TEST(Agglomeration, EveryNumberOfClustersIsAPartition) {
  const Agglomeration tree = agglomerate(draw(three_clusters(3.0), 40, 2));
  ASSERT_EQ(tree.merges.size(), 39u);
  for (Index k = 1; k <= 40; ++k) {
    const std::vector<int> labels = tree.labels(k);
    const std::set<int> distinct(labels.begin(), labels.end());
    EXPECT_EQ(std::ssize(distinct), k);
    EXPECT_EQ(*distinct.rbegin(), k - 1);
    EXPECT_EQ(labels.front(), 0);
  }
}

TEST(Agglomeration, CoincidingPointsAndOnePoint) {
  const std::vector<int> labels = agglomerate(Eigen::MatrixXd::Ones(2, 10)).labels(3);
  EXPECT_EQ(labels.size(), 10u);
  EXPECT_EQ(agglomerate(Eigen::MatrixXd::Ones(2, 1)).labels(1), std::vector<int>{0});
}

TEST(Starts, EveryKindFindsSeparateClusters) {
  const Eigen::MatrixXd points = draw(six_clusters(), 600, 3);
  EmOptions options;
  options.restarts = 3;
  const double truth = fit_em(points, six_clusters(), options).log_likelihood;
  for (const StartKind kind :
       {StartKind::automatic, StartKind::kmeans_plus_plus, StartKind::random, StartKind::hierarchical}) {
    options.start = kind;
    const EmResult fit = fit_em(points, 6, options, 1);
    EXPECT_NEAR(fit.log_likelihood, truth, 1e-3) << name_of(kind);
    EXPECT_EQ(fit.agreeing_restarts, 3) << name_of(kind);
  }
}

TEST(Kmeans, KernelsAgreeWithDistancesOneByOne) {
  for (const Index features : {1, 3, 7}) {
    std::mt19937_64 generator(5);
    const auto number = [&] { return static_cast<double>(generator() % 2000) / 1000.0 - 1.0; };
    const Eigen::MatrixXd points = Eigen::MatrixXd::NullaryExpr(features, 200, number);
    const Eigen::VectorXd weights = Eigen::VectorXd::NullaryExpr(200, [&] { return std::abs(number()); });
    Eigen::MatrixXd centers = Eigen::MatrixXd::NullaryExpr(features, 9, number);
    centers.col(8) = centers.col(2);  // a tie: the lower index
    const PointBlocks blocks(PointSet(points, weights), FeatureScale::identity(features));
    AlignedBuffer stage = blocks.stage(), nearest(block_size);
    std::vector<int> labels(block_size);
    for (Index b = 0; b < blocks.blocks(); ++b) {
      const em::Block block = blocks.block(b, stage);
      em::kmeans_kernels().nearest(block, static_cast<int>(features), centers.data(), 9, labels.data());
      std::fill_n(nearest.data(), block_size, 1e300);
      double sum = 0.0, expected = 0.0;
      for (Index k = 0; k < 9; ++k)
        sum = em::kmeans_kernels().closer(block, static_cast<int>(features), centers.col(k).data(), nearest.data(),
                                          nearest.data());
      for (Index i = 0; i < blocks.points_in(b); ++i) {
        const Index point = b * block_size + i;
        Index best = 0;
        const double distance = (centers.colwise() - points.col(point)).colwise().squaredNorm().minCoeff(&best);
        EXPECT_EQ(labels[static_cast<std::size_t>(i)], best);
        EXPECT_NEAR(nearest.data()[i], distance, 1e-14);
        expected += weights(point) * distance;
      }
      EXPECT_NEAR(sum, expected, 1e-12);
    }
  }
}

/// Two components share one cluster, and one has two clusters: EM alone stays there.
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

/// Of K^3 / 2 moves only `most` are ever held: with 500 components all of them would not fit in memory.
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
