// Clouds too large to be copied.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "mixture/em_step.hpp"
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
