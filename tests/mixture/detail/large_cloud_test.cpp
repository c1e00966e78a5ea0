// Clouds that are too large to copy.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "ident/base/seed.hpp"
#include "mixture/detail/step.hpp"
#include "tests/mixture/mixture_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

double peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

TEST(LargeCloud, BlocksLaidOutWhenReadAreThoseThatAreKept) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 1000, 1),
                        errors = Eigen::Vector4d(0.5, 0.1, 0.1, 0.2).replicate(1, 1000);
  const Eigen::VectorXd weights = points.row(0).array().square().transpose();
  for (const PointSet& set : {PointSet(points), PointSet(points, weights), PointSet(points, weights, errors)}) {
    const FeatureScale scale = FeatureScale::of(set, 1e-6);
    const GaussianMixture mixture = scale.to_scaled(three_clusters(2.0));
    const MixtureMoments kept = expect(PointBlocks(set, scale), mixture),
                         read = expect(PointBlocks(set, scale, 0), mixture);
    EXPECT_EQ(kept.log_likelihood, read.log_likelihood);
    EXPECT_EQ(kept.sums, read.sums);
  }
}

/// Sums of r, r d and r d d' (its diagonal), computed point by point.
Eigen::MatrixXd sums_by_definition(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                   const Eigen::VectorXd& weights) {
  const Index F = points.rows();
  const bool diagonal = mixture.type == CovarianceType::diagonal;
  const Eigen::MatrixXd memberships = responsibilities(mixture, points);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(1 + F + (diagonal ? F : F * (F + 1) / 2), mixture.components());
  for (Index i = 0; i < points.cols(); ++i)
    for (Index k = 0; k < mixture.components(); ++k) {
      const double r = weights(i) * memberships(k, i);
      const Eigen::VectorXd d = points.col(i) - mixture.means.col(k);
      sums(0, k) += r;
      sums.col(k).segment(1, F) += r * d;
      for (Index a = 0, row = 1 + F; a < F; ++a)
        for (Index b = diagonal ? a : 0; b <= a; ++b) sums(row++, k) += r * d(a) * d(b);
    }
  return sums;
}

TEST(Pass, SumsAreThoseOfTheirDefinitionNearTheOriginAndFarFromIt) {
  for (const double far : {0.0, 40.0, 1e6})
    for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal})
      for (const Index features : {1, 2, 3, 4, 5}) {
        auto generator = make_generator(1, "sums of a pass", static_cast<std::uint64_t>(features));
        GaussianMixture mixture;
        mixture.type = type;
        mixture.weights.setConstant(7, 1.0 / 7.0);
        std::normal_distribution<double> normal;
        mixture.means.resize(features, 7);
        for (double& value : mixture.means.reshaped()) value = normal(generator);
        for (Index k = 0; k < 7; ++k) {
          Eigen::VectorXd a(features);
          for (double& value : a) value = 0.3 * normal(generator);
          Eigen::MatrixXd covariance = a * a.transpose() + 0.2 * Eigen::MatrixXd::Identity(features, features);
          if (type == CovarianceType::diagonal) covariance = covariance.diagonal().eval().asDiagonal();
          mixture.covariances.push_back(covariance);
        }
        mixture.means.row(0).tail(4).array() += far;
        const Eigen::MatrixXd points = sample(mixture, 700, generator);
        const Eigen::VectorXd weights = points.row(0).array().sin().square();
        const PointBlocks blocks(PointSet(points, weights), FeatureScale::identity(features));
        const MixtureMoments moments = expect(blocks, mixture);
        const Eigen::MatrixXd exact = sums_by_definition(mixture, points, weights);
        EXPECT_LT((moments.sums - exact).cwiseAbs().maxCoeff(), 1e-10 * exact.cwiseAbs().maxCoeff());
        EXPECT_EQ(measure(blocks, mixture).log_likelihood, moments.log_likelihood);
        EXPECT_NEAR(moments.log_likelihood, weights.dot(log_density(mixture, points)),
                    1e-12 * std::abs(moments.log_likelihood));
      }
}

TEST(LargeCloud, TakesLittleMoreMemoryThanItsPoints) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer has memory of its own";
#endif
  constexpr Index count = 1500000, components = 25;
  Eigen::MatrixXd points(3, count);
  std::uint64_t state = 1;
  for (double& value : points.reshaped()) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    value = static_cast<double>(state >> 40);
  }
  const double before = peak_memory_bytes();
  EmOptions options;
  options.restarts = 1;
  options.max_iterations = 1;
  const EmResult fit = fit_em(PointSet(points), components, options, 1);
  EXPECT_EQ(fit.mixture.components(), components);
  Index visited = 0;
  visit_responsibilities(fit.mixture, PointSet(points), [&](Index, const auto& block) { visited += block.cols(); });
  EXPECT_EQ(visited, count);
  EXPECT_LT(peak_memory_bytes() - before, 0.5 * static_cast<double>(sizeof(double)) * 3 * count);
}

}  // namespace
}  // namespace modebank::test
