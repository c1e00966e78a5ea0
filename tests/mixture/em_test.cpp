#include "mixture/em.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>

#include "tests/mixture/golden_mixture.hpp"
#include "tests/mixture/mixture_test_support.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

constexpr double law_tolerance = 1e-9;
/// Relative to |log L|. Allows the rounding of a sum of hundreds of terms.
constexpr double monotone_slack = 1e-12;

/// Checks that two mixtures are equal up to the tolerance.
void expect_same(const GaussianMixture& actual, const GaussianMixture& expected, double tolerance) {
  EXPECT_TRUE(near(actual.weights, expected.weights, tolerance));
  EXPECT_TRUE(near(actual.means, expected.means, tolerance));
  ASSERT_EQ(actual.covariances.size(), expected.covariances.size());
  for (std::size_t k = 0; k < expected.covariances.size(); ++k)
    EXPECT_TRUE(near(actual.covariances[k], expected.covariances[k], tolerance)) << "component " << k;
}

/// Exactly the stated iterations from the same start. golden_test.cpp compares the optima alone.
TEST(Em, IterationsFromAStartAreThoseOfIndependentPrograms) {
  for (const auto& [name, unit] : golden_mixtures) {
    const nlohmann::json file = read_golden(name);
    const auto entry = [&](const char* key) { return file.contains(key) ? file[key] : nlohmann::json::array(); };
    const Eigen::MatrixXd points = golden_columns(file["points"]), errors = golden_columns(entry("errors"));
    const Eigen::VectorXd importance = golden_columns(entry("importance")).reshaped();
    GaussianMixture start{golden_rows(file["start"]["weights"]), golden_columns(file["start"]["means"]), {}, {}, {}};
    for (const auto& covariance : file["start"]["covariances"]) start.covariances.push_back(golden_rows(covariance));
    ASSERT_EQ(file["fits"].size(), 6u);
    for (const auto& expected : file["fits"]) {
      SCOPED_TRACE(name + expected["covariance"].dump() + expected["iterations"].dump());
      const auto type = expected["covariance"] == "full" ? CovarianceType::full : CovarianceType::diagonal;
      EmOptions options = fixed_iterations(expected["iterations"].get<int>(), type);
      options.covariance_floor = 1e-10;
      const EmResult fit = fit_em(PointSet(points, importance, errors), start, options);
      EXPECT_FALSE(fit.floor_active);
      EXPECT_EQ(fit.iterations, options.max_iterations);
      expect_golden_fit(expected, fit.log_likelihood, fit.mixture.weights, fit.mixture.means, fit.mixture.covariances,
                        unit);
    }
  }
}

TEST(Em, LogLikelihoodNeverFalls) {
  for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal})
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Eigen::MatrixXd points = draw(three_clusters(2.0), 300, seed);
      double previous = -std::numeric_limits<double>::infinity();
      GaussianMixture mixture = fit_em(points, unweighted, 4, fixed_iterations(0, type), seed).mixture;
      int checked = 0;
      for (int iteration = 0; iteration < 60; ++iteration) {
        const EmResult step = fit_em(points, unweighted, mixture, fixed_iterations(1, type));
        if (step.floor_active) break;
        ++checked;
        EXPECT_GE(step.log_likelihood, previous - monotone_slack * std::abs(previous)) << seed << " " << iteration;
        previous = step.log_likelihood;
        mixture = step.mixture;
      }
      EXPECT_EQ(checked, 60) << "the floor became active: nothing was tested after that, seed " << seed;
    }
}

TEST(Em, LogLikelihoodNeverFallsWithActiveFloorEither) {
  Eigen::MatrixXd points = draw(three_clusters(4.0), 200, 3);
  points.row(1) = 2.0 * points.row(0);  // singular
  double previous = -std::numeric_limits<double>::infinity();
  for (int iterations = 0; iterations < 30; ++iterations) {
    const EmResult fit = fit_em(points, unweighted, three_clusters(4.0), fixed_iterations(iterations));
    EXPECT_EQ(fit.floor_active, iterations > 0);
    EXPECT_GE(fit.log_likelihood, previous - monotone_slack * std::abs(previous)) << iterations;
    previous = fit.log_likelihood;
  }
}

/// Restarts use extrapolated steps. They must end at the optimum of plain EM or at a higher one, and no gain may
/// remain.
TEST(Em, AcceleratedRestartsEndWherePlainEmDoes) {
  for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal})
    for (const bool noise : {false, true}) {
      const Eigen::MatrixXd points = draw(three_clusters(2.0), 600, 21);
      EmOptions options;
      options.covariance = type;
      options.noise_component = noise;
      options.tolerance = 1e-11;
      options.max_iterations = 20000;
      options.restarts = 1;
      options.split_merge = 0;
      const GaussianMixture start = three_clusters(2.0);
      const EmResult plain = fit_em(points, start, options);
      const EmResult accelerated = EmSweep(points, options).fit(3, 1, &start);
      ASSERT_TRUE(plain.converged && accelerated.converged);
      EXPECT_NEAR(accelerated.log_likelihood, plain.log_likelihood, 1e-5);
      EXPECT_LT(2 * accelerated.iterations, plain.iterations);
      const EmResult more = fit_em(points, accelerated.mixture, options);
      EXPECT_LE(more.iterations, 2);
      for (Index k = 0; k < 3; ++k)
        EXPECT_LT((more.mixture.means.col(k) - accelerated.mixture.means.col(k)).norm(), 1e-3);
    }
}

TEST(Em, OneComponentHasTheWeightedSampleMoments) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 400, 5);
  const Eigen::VectorXd weights = points.row(1).array().cos().square().matrix().transpose();
  const EmResult fit = fit_em(points, weights, 1, EmOptions(), 1);
  const Eigen::VectorXd mean = points * weights / weights.sum();
  const Eigen::MatrixXd centered = points.colwise() - mean;
  EXPECT_TRUE(near(fit.mixture.means, mean, 1e-13));
  EXPECT_TRUE(
      near(fit.mixture.covariances[0], centered * weights.asDiagonal() * centered.transpose() / weights.sum(), 1e-12));
  EXPECT_EQ(fit.mixture.weights(0), 1.0);
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(fit.agreeing_restarts, EmOptions().restarts);
}

TEST(Em, PermutedPointsGiveTheSameMixture) {
  const Eigen::MatrixXd points = draw(three_clusters(2.5), 400, 6);
  std::vector<Index> order(400);
  std::iota(order.begin(), order.end(), Index(0));
  std::shuffle(order.begin(), order.end(), std::mt19937_64(1));
  const EmResult a = fit_em(points, unweighted, three_clusters(2.0), fixed_iterations(100));
  const EmResult b = fit_em(points(Eigen::all, order), unweighted, three_clusters(2.0), fixed_iterations(100));
  expect_same(b.mixture, a.mixture, law_tolerance);
}

TEST(Em, IntegerWeightsEqualRepeatedPoints) {
  const Eigen::MatrixXd points = draw(three_clusters(2.5), 300, 9);
  Eigen::VectorXd weights(300);
  std::vector<Index> repeated;
  for (Index i = 0; i < 300; ++i) {
    weights(i) = static_cast<double>(i % 4);  // includes zero
    repeated.insert(repeated.end(), static_cast<std::size_t>(i % 4), i);
  }
  const EmResult a = fit_em(points, weights, three_clusters(2.0), fixed_iterations(100));
  const EmResult b = fit_em(points(Eigen::all, repeated), unweighted, three_clusters(2.0), fixed_iterations(100));
  expect_same(a.mixture, b.mixture, law_tolerance);
  EXPECT_NEAR(a.log_likelihood, b.log_likelihood, 1e-8);
}

TEST(Em, UnitsOfAFeatureChangeNothingButUnits) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 400, 10);
  const EmResult base = fit_em(points, unweighted, 3, EmOptions(), 1);
  for (const double unit : {1e-6, 1e6}) {
    Eigen::MatrixXd scaled = points;
    scaled.row(1) *= unit;
    EmResult fit = fit_em(scaled, unweighted, 3, EmOptions(), 1);
    fit.mixture.means.row(1) /= unit;
    for (Eigen::MatrixXd& covariance : fit.mixture.covariances) {
      covariance.row(1) /= unit;
      covariance.col(1) /= unit;
    }
    expect_same(fit.mixture, base.mixture, law_tolerance);
    EXPECT_EQ(fit.iterations, base.iterations);
    EXPECT_NEAR(fit.log_likelihood, base.log_likelihood - 400.0 * std::log(unit), 1e-7);
  }
}

TEST(Em, FindsSeparatedClustersAndOrdersThemByWeight) {
  const GaussianMixture truth = three_clusters(12.0);
  const EmResult fit = fit_em(draw(truth, 3000, 11), unweighted, 3, EmOptions(), 1);
  EXPECT_TRUE(fit.converged);
  EXPECT_FALSE(fit.floor_active);
  EXPECT_GE(fit.agreeing_restarts, 2);  // several restarts find well-separated clusters (twelve standard deviations
                                        // apart)

  // The tolerances are six standard errors: 0.0091 for a weight, 0.045 for a mean (600 points), 0.07 for a variance.
  EXPECT_TRUE(near(fit.mixture.weights, truth.weights, 6 * 0.0091));
  EXPECT_TRUE(near(fit.mixture.means, truth.means, 6 * 0.045));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(near(fit.mixture.covariances[k], truth.covariances[k], 6 * 0.07));
}

TEST(Em, StartKeepsItsOrder) {
  GaussianMixture start = three_clusters(12.0);
  start.means = start.means.rowwise().reverse().eval();
  std::reverse(start.covariances.begin(), start.covariances.end());
  const EmResult fit = fit_em(draw(three_clusters(12.0), 1000, 12), unweighted, start, EmOptions());
  EXPECT_LT(fit.mixture.weights(0), fit.mixture.weights(1));
  EXPECT_LT(fit.mixture.weights(1), fit.mixture.weights(2));
}

TEST(Em, SameSeedSameResultOtherSeedOtherStarts) {
  const Eigen::MatrixXd points = draw(three_clusters(1.0), 300, 14);
  EmOptions none = fixed_iterations(0);
  EXPECT_EQ(fit_em(points, unweighted, 4, none, 1).mixture.means, fit_em(points, unweighted, 4, none, 1).mixture.means);
  EXPECT_NE(fit_em(points, unweighted, 4, none, 1).mixture.means, fit_em(points, unweighted, 4, none, 2).mixture.means);
}

TEST(Em, ResultIsBitwiseTheSameForAnyNumberOfThreads) {
  for (const Index count : {Index(700), Index(30000)}) {  // first parallel over restarts, then over blocks
    const Eigen::MatrixXd points = draw(three_clusters(2.0), count, 15);
    EmOptions options = fixed_iterations(15);
    options.restarts = 3;
    std::vector<EmResult> results;
    for (const std::size_t threads : {1u, 2u, 5u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      results.push_back(fit_em(points, unweighted, 3, options, 1));
    }
    for (const EmResult& result : results) {
      EXPECT_EQ(result.log_likelihood, results[0].log_likelihood);
      EXPECT_EQ(result.mixture.weights, results[0].mixture.weights);
      EXPECT_EQ(result.mixture.means, results[0].mixture.means);
      EXPECT_EQ(result.mixture.covariances, results[0].mixture.covariances);
    }
  }
}

}  // namespace
}  // namespace modebank::test
