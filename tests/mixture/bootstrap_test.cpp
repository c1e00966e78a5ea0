// Standard errors of a mixture by resampling runs: against what repeated sampling shows.
#include "mixture/bootstrap.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/mixture/mixture_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

constexpr Index runs = 30, per_run = 12;

struct Study {
  Eigen::MatrixXd points{1, runs* per_run};
  std::vector<Index> run_of_point;
};

/// Each run stays in one of two clusters (weight 0.7 and 0.3) and has an offset of its own (sd 0.5): points of a run
/// say the same thing again, so only the number of runs counts.
Study draw_study(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Study study;
  for (Index r = 0; r < runs; ++r) {
    const double center = (uniform(generator) < 0.7 ? 0.0 : 10.0) + 0.5 * normal(generator);
    for (Index i = 0; i < per_run; ++i) {
      study.points(0, r * per_run + i) = center + 0.3 * normal(generator);
      study.run_of_point.push_back(r);
    }
  }
  return study;
}

GaussianMixture two_clusters() {
  GaussianMixture mixture;
  mixture.weights = Eigen::Vector2d(0.7, 0.3);
  mixture.means = Eigen::RowVector2d(0.0, 10.0);
  mixture.covariances.assign(2, Eigen::MatrixXd::Constant(1, 1, 0.34));
  return mixture;
}

TEST(Bootstrap, IntervalsCoverTheTruth) {
  constexpr int studies = 200;
  int weight_covered = 0, mean_covered = 0;
  for (int s = 0; s < studies; ++s) {
    const Study study = draw_study(static_cast<std::uint64_t>(s) + 1);
    const EmOptions options;
    const GaussianMixture fit = fit_em(study.points, two_clusters(), options).mixture;
    const MixtureErrors errors = bootstrap_runs(study.points, study.run_of_point, fit, options, 60, 1);
    weight_covered += std::abs(fit.weights(0) - 0.7) <= 1.96 * errors.weights(0);
    mean_covered += std::abs(fit.means(0, 0)) <= 1.96 * errors.means(0, 0);
  }
  // 95 % nominal; 30 runs and 200 studies (standard error 1.5 %). Points as if independent would cover about 45 %.
  EXPECT_GE(weight_covered, 0.88 * studies);
  EXPECT_LE(weight_covered, 0.99 * studies);
  EXPECT_GE(mean_covered, 0.88 * studies);
  EXPECT_LE(mean_covered, 0.99 * studies);
}

TEST(Bootstrap, DoesNotDependOnTheOrderOfComponents) {
  const Study study = draw_study(1);
  const GaussianMixture fit = fit_em(study.points, two_clusters(), EmOptions{}).mixture;
  GaussianMixture swapped = fit;
  swapped.weights = fit.weights.reverse();
  swapped.means = fit.means.rowwise().reverse();
  std::swap(swapped.covariances[0], swapped.covariances[1]);
  const MixtureErrors a = bootstrap_runs(study.points, study.run_of_point, fit, EmOptions{}, 20, 1);
  const MixtureErrors b = bootstrap_runs(study.points, study.run_of_point, swapped, EmOptions{}, 20, 1);
  for (Index k = 0; k < 2; ++k) {
    EXPECT_NEAR(a.weights(k), b.weights(1 - k), 1e-8);
    EXPECT_NEAR(a.means(0, k), b.means(0, 1 - k), 1e-8);
  }
}

TEST(Bootstrap, OneRunTellsNothing) {
  const Study study = draw_study(1);
  const std::vector<Index> one(study.run_of_point.size(), 4);
  const MixtureErrors errors = bootstrap_runs(study.points, one, two_clusters(), EmOptions{}, 20, 1);
  EXPECT_TRUE(errors.weights.array().isNaN().all());
  EXPECT_TRUE(errors.means.array().isNaN().all());
}

TEST(Bootstrap, AComponentOfOneRunHasNoMeanToVary) {
  Study study = draw_study(1);
  for (Index i = 0; i < per_run; ++i) study.points(0, i) += 100.0;  // one run far out
  GaussianMixture start = two_clusters();
  start.weights = Eigen::Vector3d(0.6, 0.3, 0.1);
  start.means = Eigen::RowVector3d(0.0, 10.0, study.points.row(0).head(per_run).mean());
  start.covariances.push_back(start.covariances[0]);
  const GaussianMixture fit = fit_em(study.points, start, EmOptions{}).mixture;
  const MixtureErrors errors = bootstrap_runs(study.points, study.run_of_point, fit, EmOptions{}, 50, 1);
  // It is in 1 - 1/e of the resamples: its weight varies, its mean is the same wherever it is.
  EXPECT_GT(errors.weights(2), 0.0);
  EXPECT_LT(errors.means(0, 2), 0.05);
}

}  // namespace
}  // namespace modebank::test
