// Bad or degenerate clouds must give a defined result or a clear error, never NaN.
#include <gtest/gtest.h>

#include <limits>

#include "ident/base/not_a_number.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

void expect_sound(const EmResult& fit, const Eigen::MatrixXd& points) {
  EXPECT_TRUE(is_finite(fit.mixture));
  EXPECT_TRUE(std::isfinite(fit.log_likelihood));
  EXPECT_TRUE(log_density(fit.mixture, points).allFinite());
  EXPECT_TRUE(responsibilities(fit.mixture, points).allFinite());
}

class Robustness : public ::testing::TestWithParam<CovarianceType> {
 protected:
  EmResult fit(const Eigen::MatrixXd& points, Eigen::Index components) const {
    EmOptions options;
    options.covariance = GetParam();
    return fit_em(points, unweighted, components, options, 1);
  }
};

INSTANTIATE_TEST_SUITE_P(Types, Robustness, ::testing::Values(CovarianceType::full, CovarianceType::diagonal));

TEST_P(Robustness, IdenticalPoints) {
  const Eigen::MatrixXd points = Eigen::Vector3d(1.0, -2.0, 1e6).replicate(1, 50);
  const EmResult result = fit(points, 4);
  expect_sound(result, points);
  EXPECT_TRUE(result.floor_active);
  // A constant feature keeps its unit, and its floor is 1e-6 of that unit.
  EXPECT_TRUE(near(result.mixture.means, points.leftCols(4), 1e-9));
  EXPECT_TRUE(near(result.mixture.covariances[0], 1e-6 * Eigen::Matrix3d::Identity(), 1e-18));
}

TEST_P(Robustness, ConstantFeature) {
  Eigen::MatrixXd points(3, 400);
  points.topRows(2) = draw(three_clusters(10.0), 400, 1);
  points.row(2).setConstant(7.0);
  const EmResult result = fit(points, 3);
  expect_sound(result, points);
  EXPECT_TRUE(near(result.mixture.means.row(2), Eigen::RowVector3d::Constant(7.0), 1e-12));
  EmOptions options;
  options.covariance = GetParam();
  const GaussianMixture without = fit_em(points.topRows(2), unweighted, 3, options, 1).mixture;
  EXPECT_TRUE(near(result.mixture.means.topRows(2), without.means, 1e-9));
}

TEST_P(Robustness, SinglePoint) {
  const Eigen::MatrixXd points = Eigen::Vector2d(3.0, 4.0);
  const EmResult result = fit(points, 1);
  expect_sound(result, points);
  EXPECT_TRUE(near(result.mixture.means, points, 0.0));
}

TEST_P(Robustness, ExtremeOutlier) {
  for (const double distance : {1e8, 1e100}) {
    Eigen::MatrixXd points = draw(three_clusters(3.0), 500, 3);
    points.col(17).setConstant(distance);
    const EmResult result = fit(points, 2);
    expect_sound(result, points);
    // Two components are expected: one for the outlier, and one for all other points.
    EXPECT_NEAR(result.mixture.weights(0), 499.0 / 500.0, 1e-6);
    EXPECT_NEAR(result.mixture.means(0, 1) / distance, 1.0, 1e-6);
  }
}

TEST_P(Robustness, OutliersHideNoClusters) {
  const GaussianMixture truth = three_clusters(8.0);
  for (const double distance : {1e3, 1e5, 1e6}) {
    Eigen::MatrixXd points = draw(truth, 600, 3);
    points.col(17) << distance, -0.3 * distance;
    const EmResult result = fit(points, 4);
    expect_sound(result, points);
    for (Eigen::Index k = 0; k < 3; ++k)
      EXPECT_LT((result.mixture.means.colwise() - truth.means.col(k)).colwise().norm().minCoeff(), 0.5) << distance;
    EXPECT_NEAR(result.mixture.weights(3), 1.0 / 600.0, 1e-6);
    EXPECT_NEAR(result.mixture.means(0, 3) / distance, 1.0, 1e-6);
  }
}

TEST_P(Robustness, NoiseTakesAnOutlierOfOneFeature) {
  const GaussianMixture truth = three_clusters(8.0);
  Eigen::MatrixXd points = draw(truth, 600, 3);
  points(1, 17) = 1e6;
  EmOptions options;
  options.covariance = GetParam();
  options.noise_component = true;
  const EmResult result = fit_em(points, unweighted, 3, options, 1);
  expect_sound(result, points);
  for (Eigen::Index k = 0; k < 3; ++k)
    EXPECT_LT((result.mixture.means.colwise() - truth.means.col(k)).colwise().norm().minCoeff(), 0.5);
  EXPECT_NEAR(result.mixture.noise.weight, 1.0 / 600.0, 1e-3);
}

TEST_P(Robustness, ConstantFeatureOfAnyMagnitudeWithNoise) {
  for (const double constant : {0.0, 1e13, -1e140}) {
    Eigen::MatrixXd points = draw(three_clusters(8.0), 200, 3);
    points.row(1).setConstant(constant);
    EmOptions options;
    options.covariance = GetParam();
    options.noise_component = true;
    const EmResult result = fit_em(points, unweighted, 2, options, 1);
    expect_sound(result, points);
    EXPECT_TRUE((result.mixture.noise.upper.array() > result.mixture.noise.lower.array()).all());
  }
}

TEST_P(Robustness, TinyAndHugeUnits) {
  for (const double unit : {1e-100, 1e100}) {
    const Eigen::MatrixXd points = unit * draw(three_clusters(8.0), 300, 4);
    const EmResult result = fit(points, 3);
    expect_sound(result, points);
    EXPECT_FALSE(result.floor_active);
  }
}

TEST_P(Robustness, StarvedComponentKeepsItsPlace) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 300, 5);
  GaussianMixture start = three_clusters(3.0);
  start.means.col(2).setConstant(1e4);  // this component explains no point
  EmOptions options;
  options.covariance = GetParam();
  const EmResult result = fit_em(points, unweighted, start, options);
  expect_sound(result, points);
  EXPECT_LT(result.mixture.weights(2), 1e-14);
  EXPECT_TRUE(near(result.mixture.means.col(2), start.means.col(2), 1e-8));
}

TEST_P(Robustness, SinglePointComponents) {
  Eigen::MatrixXd points(2, 43);
  points.leftCols(40) = draw(three_clusters(1.0), 40, 6);
  points.rightCols(3) << 1e3, -1e3, 0.0, 1e3, 1e3, -1e3;  // three points far from all others
  const EmResult result = fit(points, 4);
  expect_sound(result, points);
  EXPECT_TRUE(result.floor_active);  // a single point has no extent
}

TEST_P(Robustness, NoDegenerateCloudEndsTheSweep) {
  std::vector<Eigen::MatrixXd> clouds{Eigen::Vector2d(1.0, 2.0).replicate(1, 30), draw(three_clusters(3.0), 30, 8),
                                      draw(three_clusters(3.0), 30, 9), draw(three_clusters(3.0), 9, 10)};
  clouds[1].col(0).setConstant(1e100);
  clouds[2].row(1).setConstant(-3.0);
  for (const bool noise : {false, true})
    for (const bool errors : {false, true})
      for (const Eigen::MatrixXd& points : clouds) {
        FeatureCloud cloud = cloud_of(points, 3);
        if (errors) cloud.covariances = Eigen::Vector4d(1e-3, 0.0, 0.0, 1e-3).replicate(1, points.cols());
        SelectionOptions options;
        options.components = {1, 2, 3, 4, 5, 6, 7, 8, 9};
        options.em.covariance = GetParam();
        options.em.restarts = 2;
        options.em.noise_component = noise;
        const MixtureResult result = select_mixture(fits_of(cloud, 5, 1), cloud, options, 1);
        EXPECT_EQ(result.candidates.size(), 9u);
        EXPECT_TRUE(result.mixture.means.allFinite());
        EXPECT_TRUE(result.responsibilities.all().allFinite());
        for (const Candidate& row : result.candidates)
          EXPECT_TRUE(std::isfinite(row.log_likelihood) || row.status == CandidateStatus::too_few_points)
              << row.components;
      }
}

TEST(RobustnessErrors, CallersMistakesThrow) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 20, 1);
  const EmOptions options;
  EXPECT_THROW(fit_em(points, unweighted, 0, options, 1), std::invalid_argument);
  EXPECT_THROW(fit_em(points, unweighted, 21, options, 1), std::invalid_argument);
  EXPECT_THROW(fit_em(points, Eigen::VectorXd::Ones(19), 2, options, 1), std::invalid_argument);
  EXPECT_THROW(fit_em(points, -Eigen::VectorXd::Ones(20), 2, options, 1), std::invalid_argument);
  EXPECT_THROW(fit_em(points, Eigen::VectorXd::Zero(20), 2, options, 1), std::invalid_argument);
  for (const double bad : {not_a_number, std::numeric_limits<double>::infinity(), 1e200}) {
    Eigen::MatrixXd broken = points;
    broken(1, 3) = bad;
    EXPECT_THROW(fit_em(broken, unweighted, 2, options, 1), std::invalid_argument) << bad;
  }
  EXPECT_THROW(fit_em(points.topRows(1), unweighted, three_clusters(3.0), options), std::invalid_argument);
  EmOptions wrong;
  wrong.restarts = 0;
  EXPECT_THROW(fit_em(points, unweighted, 2, wrong, 1), std::invalid_argument);
  wrong = EmOptions();
  wrong.covariance_floor = 0.0;
  EXPECT_THROW(fit_em(points, unweighted, 2, wrong, 1), std::invalid_argument);
}

/// The floor is a share of each feature's error variance, whatever the points.
TEST(Robustness, TheFloorIsRelativeToThePointsErrors) {
  EmOptions options;
  options.covariance_floor = 1e-4;
  const Eigen::VectorXd error = Eigen::Vector2d(0.5, 4.0);
  const Eigen::Matrix2d floored = (1e-4 * error.array().square()).matrix().asDiagonal();
  const Eigen::MatrixXd spot = Eigen::Vector2d(3.0, 4.0).replicate(1, 30);
  const PointSet set(spot, detail::no_weights, detail::no_covariances, error);
  EXPECT_TRUE(near(fit_em(set, 1, options, 1).mixture.covariances[0], floored, 1e-15));
  Eigen::MatrixXd two(2, 60);
  two << spot, (spot.array() + 2.0).matrix();
  const EmResult fit = fit_em(PointSet(two, detail::no_weights, detail::no_covariances, error), 2, options, 1);
  EXPECT_TRUE(fit.floor_active);
  for (const Eigen::MatrixXd& covariance : fit.mixture.covariances) EXPECT_TRUE(near(covariance, floored, 1e-12));
  EXPECT_NEAR(fit.log_likelihood, log_density(fit.mixture, two).sum(), 1e-6);
  const Eigen::VectorXd wrong = Eigen::Vector2d(0.5, -1.0);
  EXPECT_THROW(fit_em(PointSet(two, detail::no_weights, detail::no_covariances, wrong), 2, options, 1),
               std::invalid_argument);
}

}  // namespace
}  // namespace modebank::test
