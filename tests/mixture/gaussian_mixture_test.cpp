#include "mixture/gaussian_mixture.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <type_traits>

#include "ident/base/not_a_number.hpp"
#include "mixture/detail/cloud.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

constexpr double rounding = 1e-14;

// The compiler must reject temporaries: PointSet set(x.leftCols(3)) once referred to freed memory.
static_assert(std::is_constructible_v<PointSet, Eigen::MatrixXd&>);
static_assert(!std::is_constructible_v<PointSet, Eigen::MatrixXd>);
static_assert(!std::is_constructible_v<PointSet, decltype(std::declval<Eigen::MatrixXd&>().leftCols(3))>);

TEST(GaussianMixture, CountsFreeParameters) {
  GaussianMixture mixture = three_clusters(3.0);
  EXPECT_EQ(mixture.parameter_count(), 2 + 6 + 9);  // K = 3, F = 2
  mixture.type = CovarianceType::diagonal;
  EXPECT_EQ(mixture.parameter_count(), 2 + 6 + 6);
}

TEST(GaussianMixture, DensityFollowsItsFormulaForAnyNumberOfFeatures) {
  for (Eigen::Index features = 1; features <= 11; ++features) {  // these sizes use every specialised kernel and the
                                                                 // general kernel
    GaussianMixture mixture;
    mixture.weights = Eigen::VectorXd::Ones(1);
    mixture.means = Eigen::VectorXd::LinSpaced(features, -1.0, 2.0);
    // Correlations that fall with distance (Kac, Murdock & Szego 1953): the determinant is (1 - 0.25)^(F - 1).
    mixture.covariances.emplace_back(features, features);
    for (Eigen::Index i = 0; i < features; ++i)
      for (Eigen::Index j = 0; j < features; ++j)
        mixture.covariances[0](i, j) = std::pow(0.5, static_cast<double>(std::abs(i - j)));
    // d' Sigma^-1 d = d_1^2 + sum (d_i - 0.5 d_(i-1))^2 / 0.75, the formula of a first-order autoregression.
    const Eigen::VectorXd d = Eigen::VectorXd::LinSpaced(features, 0.3, -1.7).array().sin();
    double distance = d(0) * d(0);
    for (Eigen::Index i = 1; i < features; ++i) distance += std::pow(d(i) - 0.5 * d(i - 1), 2) / 0.75;
    const double expected = -0.5 * (distance + static_cast<double>(features - 1) * std::log(0.75) +
                                    static_cast<double>(features) * std::log(2.0 * std::numbers::pi));
    const Eigen::VectorXd point = mixture.means.col(0) + d;
    EXPECT_NEAR(log_density(mixture, point)(0), expected, 1e-13) << features << " features";
  }
}

TEST(GaussianMixture, FarPointsHaveFiniteDensityAndProperResponsibilities) {
  for (const double distance : {1e2, 1e8, 1e100, 1e160, 1e300, -1e308}) {
    Eigen::MatrixXd points = Eigen::MatrixXd::Constant(2, 1, distance);
    for (const double sign : {1.0, -1.0}) {
      points(1, 0) = sign * distance;
      const double density = log_density(three_clusters(3.0), points)(0);
      EXPECT_TRUE(std::isfinite(density)) << distance;
      EXPECT_LT(density, -1e3) << distance;
      const Eigen::VectorXd r = responsibilities(three_clusters(3.0), points);
      EXPECT_NEAR(r.sum(), 1.0, rounding) << distance;
      EXPECT_GE(r.minCoeff(), 0.0) << distance;
    }
  }
}

TEST(GaussianMixture, ComponentOfZeroWeightIsAsAbsent) {
  GaussianMixture mixture = three_clusters(3.0), two = mixture;
  const Eigen::MatrixXd points = draw(mixture, 100, 2);
  mixture.weights = Eigen::Vector3d(0.6, 0.4, 0.0);
  two.weights = Eigen::Vector2d(0.6, 0.4);
  two.means.conservativeResize(2, 2);
  two.covariances.pop_back();
  EXPECT_TRUE(near(log_density(mixture, points), log_density(two, points), rounding));
  EXPECT_LT(responsibilities(mixture, points).row(2).maxCoeff(), 1e-200);
}

TEST(GaussianMixture, SampleHasTheMixturesMoments) {
  const GaussianMixture mixture = three_clusters(4.0);
  constexpr Eigen::Index count = 200000;
  const Eigen::MatrixXd points = draw(mixture, count, 3);
  const Eigen::VectorXd mean = mixture.means * mixture.weights;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(2, 2);
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::VectorXd offset = mixture.means.col(k) - mean;
    covariance += mixture.weights(k) * (mixture.covariances[k] + offset * offset.transpose());
  }
  const Eigen::VectorXd sample_mean = points.rowwise().mean();
  const Eigen::MatrixXd centered = points.colwise() - sample_mean;
  // The tolerance is five standard errors of a mean, and more than five of a second moment.
  const double standard_error = std::sqrt(covariance.diagonal().maxCoeff() / count);
  EXPECT_TRUE(near(sample_mean, mean, 5.0 * standard_error));
  EXPECT_TRUE(near(centered * centered.transpose() / count, covariance,
                   10.0 * standard_error * std::sqrt(covariance.diagonal().maxCoeff())));
}

TEST(GaussianMixture, RejectsWhatDoesNotFit) {
  GaussianMixture mixture = three_clusters(3.0);
  EXPECT_THROW(log_density(mixture, Eigen::MatrixXd::Zero(3, 5)), std::invalid_argument);
  mixture.covariances[1] = -Eigen::Matrix2d::Identity();
  EXPECT_THROW(responsibilities(mixture, Eigen::MatrixXd::Zero(2, 5)), std::invalid_argument);
  mixture.covariances.pop_back();
  EXPECT_THROW(log_density(mixture, Eigen::MatrixXd::Zero(2, 5)), std::invalid_argument);
}

TEST(GaussianMixture, RejectsNumbersThatNoMixtureHas) {
  const GaussianMixture sound = three_clusters(3.0);
  const Eigen::MatrixXd points = Eigen::MatrixXd::Zero(2, 5);
  std::mt19937_64 generator(1);
  const auto expect_rejected = [&](const GaussianMixture& mixture) {
    EXPECT_THROW(log_density(mixture, points), std::invalid_argument);
    EXPECT_THROW(responsibilities(mixture, points), std::invalid_argument);
    EXPECT_THROW(sample(mixture, 3, generator), std::invalid_argument);
  };
  GaussianMixture broken = sound;
  broken.weights(1) = -0.1;
  expect_rejected(broken);
  broken.weights(1) = not_a_number;
  expect_rejected(broken);
  broken = sound;
  broken.means(0, 2) = not_a_number;
  expect_rejected(broken);
  broken = sound;
  broken.weights.setZero();
  EXPECT_THROW(sample(broken, 3, generator), std::invalid_argument);
  EXPECT_THROW(sample(sound, -1, generator), std::invalid_argument);
  EXPECT_EQ(sample(sound, 0, generator).cols(), 0);
  EXPECT_THROW(log_density(sound, Eigen::MatrixXd::Constant(2, 5, not_a_number)), std::invalid_argument);
}

}  // namespace
}  // namespace modebank::test
