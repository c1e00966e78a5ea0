// Crossing of restarts, and climbs that end early.
#include "mixture/detail/restarts.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "mixture/detail/iterate.hpp"
#include "mixture/detail/starts.hpp"
#include "mixture/select.hpp"
#include "tests/mixture/mixture_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

/// Four clusters in a row, at equal distances.
GaussianMixture four_in_a_row() {
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(4, 0.25);
  mixture.means.resize(2, 4);
  mixture.means << 0, 10, 20, 30, 0, 1, 0, 1;
  mixture.covariances.assign(4, 0.5 * Eigen::Matrix2d::Identity());
  return mixture;
}

/// The same mixture with two errors: one cluster is split in two, and two clusters are merged.
GaussianMixture with_error(Index divided, Index first, Index second) {
  GaussianMixture mixture = four_in_a_row();
  mixture.means.col(first) = 0.5 * (mixture.means.col(first) + mixture.means.col(second));
  mixture.covariances[first](0, 0) = 25.0;
  mixture.means.col(second) = mixture.means.col(divided) + Eigen::Vector2d(0.5, 0.0);
  mixture.means.col(divided).x() -= 0.5;
  return mixture;
}

/// One mixture is wrong at one end of the row of clusters, the other mixture at the other end. Their child must be
/// right at both ends.
TEST(Cross, TakesWhatIsRightInEither) {
  const Eigen::MatrixXd points = draw(four_in_a_row(), 800, 3);
  const GaussianMixture left = with_error(3, 0, 1), right = with_error(0, 2, 3);
  const double truth = log_density(four_in_a_row(), points).sum();
  ASSERT_LT(log_density(left, points).sum(), truth - 300.0);
  ASSERT_LT(log_density(right, points).sum(), truth - 300.0);
  EmOptions options;
  const double child = fit_em(PointSet(points), cross(left, right), options).log_likelihood;
  EXPECT_GT(child, truth - 1.0);
}

/// Agreement counts the optima that each restart finds by itself, so it must equal the agreement of separate single
/// restarts. After crossing with the best restart, nearly all would agree.
TEST(Restarts, AgreementIsCountedBeforeCrossing) {
  GaussianMixture truth;
  constexpr Index clusters = 9;
  truth.weights = Eigen::VectorXd::Constant(clusters, 1.0 / clusters);
  truth.means.resize(2, clusters);
  for (Index k = 0; k < clusters; ++k)
    truth.means.col(k) << 4.0 * static_cast<double>(k % 3), 4.0 * static_cast<double>(k / 3);
  truth.covariances.assign(clusters, Eigen::Matrix2d::Identity());
  int disagreeing = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Eigen::MatrixXd points = draw(truth, 300, seed);
    EmOptions options;
    options.restarts = 6;
    options.split_merge = 1;
    const ScaledCloud cloud(PointSet(points), options);
    const auto start_of = [&](int i) { return make_start(cloud, clusters + 2, i, options, seed); };
    const EmResult all = best_of_restarts(cloud.points, start_of, options, seed);
    EmOptions one = options;
    one.restarts = 1;
    int agreeing = 0;
    for (int i = 0; i < options.restarts; ++i) {
      const EmResult alone = best_of_restarts(
          cloud.points, [&](int) { return start_of(i); }, one, seed);
      agreeing += alone.log_likelihood >= all.log_likelihood - 1e-4 * 300.0 ? 1 : 0;
    }
    EXPECT_EQ(all.agreeing_restarts, agreeing) << seed;
    disagreeing += options.restarts - agreeing;
  }
  EXPECT_GT(disagreeing, 4) << "the comparison shows nothing";
}

TEST(Restarts, ClimbsWithoutHopeAreGivenUp) {
  const Eigen::MatrixXd points = draw(three_clusters(2.0), 600, 6);
  const PointBlocks blocks(PointSet(points), FeatureScale::identity(points.rows()));
  EmOptions options;
  options.tolerance = 1e-10;
  const EmResult all = iterate(blocks, three_clusters(2.0), options, Steps::extrapolated);
  ASSERT_TRUE(all.converged);
  const EmResult hopeless =
      iterate(blocks, three_clusters(2.0), options, Steps::extrapolated, all.log_likelihood + 100.0);
  EXPECT_FALSE(hopeless.converged);
  EXPECT_LT(2 * hopeless.iterations, all.iterations);
  const EmResult reached =
      iterate(blocks, three_clusters(2.0), options, Steps::extrapolated, all.log_likelihood - 1e-6);
  EXPECT_NEAR(reached.log_likelihood, all.log_likelihood, 1e-6) << "what can be reached is not given up";
}

TEST(Restarts, BadOptionsAreNamed) {
  const Eigen::MatrixXd points = draw(four_in_a_row(), 50, 7);
  const auto refused = [&](auto change) {
    SelectionOptions options;
    options.components = {2};
    double samples = 0.0;
    change(options, samples);
    EXPECT_THROW(select(points, samples, options, 1), std::invalid_argument);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused([&](SelectionOptions& options, double&) { options.em.tolerance = nan; });
  refused([&](SelectionOptions& options, double&) { options.em.covariance_floor = 1e300 * 1e300; });
  refused([&](SelectionOptions& options, double&) { options.em.restarts = 0; });
  refused([&](SelectionOptions&, double& samples) { samples = nan; });
  refused([&](SelectionOptions&, double& samples) { samples = -3.0; });
}

}  // namespace
}  // namespace modebank::test
