// The uniform noise component, and points that belong to no cluster.
#include <gtest/gtest.h>

#include <numbers>

#include "mixture/select.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

EmOptions with_noise(int iterations = 1000) {
  EmOptions options;
  options.noise_component = true;
  options.max_iterations = iterations;
  return options;
}

/// Clusters in which a share `noise` of the points is uniform over a much larger box. Noise points and cluster points
/// alternate.
GaussianMixture noisy_clusters(double distance, double noise) {
  GaussianMixture mixture = three_clusters(distance);
  mixture.weights *= 1.0 - noise;
  mixture.noise = {noise, Eigen::Vector2d(-40.0, -40.0), Eigen::Vector2d(60.0, 60.0)};
  return mixture;
}

TEST(NoiseComponent, DensityAndResponsibilitiesByHand) {
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(1, 0.7);
  mixture.means = Eigen::MatrixXd::Zero(1, 1);
  mixture.covariances = {Eigen::MatrixXd::Identity(1, 1)};
  mixture.noise = {0.3, Eigen::VectorXd::Constant(1, -4.0), Eigen::VectorXd::Constant(1, 6.0)};
  const Eigen::MatrixXd points = (Eigen::MatrixXd(1, 4) << 0.0, 6.0, -4.0, 6.5).finished();
  const auto normal = [](double x) { return 0.7 * std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); };
  const Eigen::Vector4d density(normal(0.0) + 0.03, normal(6.0) + 0.03, normal(4.0) + 0.03, normal(6.5));
  EXPECT_TRUE(near(log_density(mixture, points), density.array().log().matrix(), 1e-14));
  const Eigen::RowVector4d expected(normal(0.0) / density(0), normal(6.0) / density(1), normal(4.0) / density(2), 1.0);
  EXPECT_TRUE(near(responsibilities(mixture, points), expected, 1e-14));
}

TEST(NoiseComponent, OneIterationFollowsTheFormulas) {
  const Eigen::MatrixXd points = draw(noisy_clusters(6.0, 0.2), 400, 1);
  EmOptions options = with_noise(1);
  options.tolerance = -1.0;
  GaussianMixture start = three_clusters(6.0);
  const EmResult fit = fit_em(points, unweighted, start, options);
  start.weights *= 0.95;
  start.noise = {0.05, points.rowwise().minCoeff(), points.rowwise().maxCoeff()};
  const Eigen::MatrixXd r = responsibilities(start, points);
  EXPECT_NEAR(fit.mixture.noise.weight, 1.0 - r.sum() / 400.0, 1e-12);
  EXPECT_TRUE(near(fit.mixture.weights, r.rowwise().mean(), 1e-12));
  EXPECT_TRUE(near(fit.mixture.means, (points * r.transpose()) * r.rowwise().sum().cwiseInverse().asDiagonal(), 1e-10));
  EXPECT_EQ(fit.mixture.noise.lower, start.noise.lower);
  EXPECT_EQ(fit.mixture.noise.upper, start.noise.upper);
  EXPECT_NEAR(fit.mixture.weights.sum() + fit.mixture.noise.weight, 1.0, 1e-14);
  EXPECT_NEAR(fit.log_likelihood, log_density(fit.mixture, points).sum(), 1e-8);
}

TEST(NoiseComponent, LogLikelihoodNeverFalls) {
  const Eigen::MatrixXd points = draw(noisy_clusters(5.0, 0.15), 500, 2);
  double previous = -std::numeric_limits<double>::infinity();
  for (int iterations = 0; iterations < 40; ++iterations) {
    EmOptions options = with_noise(iterations);
    options.tolerance = -1.0;
    const EmResult fit = fit_em(points, unweighted, three_clusters(4.0), options);
    EXPECT_GE(fit.log_likelihood, previous - 1e-12 * std::abs(previous)) << iterations;
    previous = fit.log_likelihood;
  }
}

TEST(NoiseComponent, TakesWhatBelongsToNoCluster) {
  const GaussianMixture truth = noisy_clusters(10.0, 0.1);
  const Eigen::MatrixXd points = draw(truth, 3000, 3);
  const EmResult fit = fit_em(points, unweighted, 3, with_noise(), 1),
                 plain = fit_em(points, unweighted, 3, EmOptions(), 1);
  EXPECT_NEAR(fit.mixture.noise.weight, 0.1, 6 * 0.0055);  // the tolerance is six standard errors
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_TRUE(near(fit.mixture.covariances[k], truth.covariances[k], 6 * 0.075)) << k;
  double largest = 0.0;
  for (const Eigen::MatrixXd& covariance : plain.mixture.covariances) largest = std::max(largest, covariance.trace());
  EXPECT_GT(largest, 50.0);  // without a noise component, another component explains the noise points
}

TEST(NoiseComponent, ItsWindowsGetNoLabel) {
  const Eigen::MatrixXd points = draw(noisy_clusters(10.0, 0.1), 1500, 4);
  const FeatureCloud cloud = cloud_of(points, 5);
  SelectionOptions options;
  options.components = {1, 2, 3, 4};
  options.em = with_noise();
  const MixtureResult result = select_mixture(fits_of(cloud, 1, 1), cloud, options, 1);
  EXPECT_EQ(result.mixture.components(), 3);
  const Eigen::MatrixXd r = result.responsibilities.all();
  Index noise = 0;
  for (Index i = 0; i < 1500; ++i) {
    Index largest = 0;
    const bool is_noise = 1.0 - r.col(i).sum() > r.col(i).maxCoeff(&largest);
    noise += is_noise ? 1 : 0;
    EXPECT_EQ(result.labels(i), is_noise ? -1 : largest);
  }
  EXPECT_NEAR(static_cast<double>(noise), 150.0, 60.0);
  for (const Candidate& row : result.candidates) EXPECT_EQ(row.parameters, row.components - 1 + 5 * row.components + 2);
}

TEST(NoiseComponent, ABoxThatIsNoneIsRefused) {
  GaussianMixture mixture = noisy_clusters(3.0, 0.1);
  mixture.noise.upper(1) = mixture.noise.lower(1);
  EXPECT_THROW(log_density(mixture, Eigen::MatrixXd::Zero(2, 5)), std::invalid_argument);
  mixture.noise.upper.resize(3);
  EXPECT_THROW(log_density(mixture, Eigen::MatrixXd::Zero(2, 5)), std::invalid_argument);
}

}  // namespace
}  // namespace modebank::test
