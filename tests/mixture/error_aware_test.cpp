// EM on points with error covariances (extreme deconvolution).
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "ident/fit/fit_windows.hpp"
#include "mixture/select.hpp"
#include "tests/mixture/mixture_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

EmOptions unfloored(int iterations, CovarianceType type = CovarianceType::full) {
  EmOptions options = fixed_iterations(iterations, type);
  options.covariance_floor = 1e-10;
  return options;
}

/// Random covariances of size `scale` squared, one per column.
Eigen::MatrixXd random_errors(Index features, Index count, double scale, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0.0, scale);
  Eigen::MatrixXd errors(features * features, count);
  for (Index i = 0; i < count; ++i) {
    const Eigen::MatrixXd A = Eigen::MatrixXd::NullaryExpr(features, features, [&] { return normal(generator); });
    Eigen::Map<Eigen::MatrixXd>(errors.col(i).data(), features, features) = A * A.transpose();
  }
  return errors;
}

/// The points, each with a random error of its covariance added.
Eigen::MatrixXd with_errors(Eigen::MatrixXd points, const Eigen::MatrixXd& errors, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const Index F = points.rows();
  for (Index i = 0; i < points.cols(); ++i) {
    const Eigen::Map<const Eigen::MatrixXd> S(errors.col(i).data(), F, F);
    points.col(i) += S.llt().matrixL() * Eigen::VectorXd::NullaryExpr(F, [&] { return normal(generator); });
  }
  return points;
}

/// A mixture of K components in any number of features.
GaussianMixture any_mixture(Index features, Index components) {
  GaussianMixture mixture;
  mixture.weights = Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components));
  mixture.means = Eigen::MatrixXd::NullaryExpr(
      features, components, [](Index f, Index k) { return 3.0 * std::sin(static_cast<double>(5 * k + 2 * f)); });
  for (Index k = 0; k < components; ++k) {
    const Eigen::MatrixXd S = random_errors(features, 1, 0.6, static_cast<std::uint64_t>(7 * k + features));
    mixture.covariances.emplace_back(S.reshaped(features, features) +
                                     0.2 * Eigen::MatrixXd::Identity(features, features));
  }
  return mixture;
}

double difference(const EmResult& a, const EmResult& b) {
  double worst = std::max((a.mixture.means - b.mixture.means).cwiseAbs().maxCoeff(),
                          (a.mixture.weights - b.mixture.weights).cwiseAbs().maxCoeff());
  for (std::size_t k = 0; k < a.mixture.covariances.size(); ++k)
    worst = std::max(worst, (a.mixture.covariances[k] - b.mixture.covariances[k]).cwiseAbs().maxCoeff());
  return worst;
}

TEST(ErrorAware, ZeroErrorsGiveThePlainFit) {
  for (const Index features : {1, 2, 3, 4, 6})
    for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal}) {
      const GaussianMixture truth = any_mixture(features, 3);
      const Eigen::MatrixXd points = draw(truth, 333, 5), none = Eigen::MatrixXd::Zero(features * features, 333);
      const EmResult plain = fit_em(PointSet(points), truth, unfloored(30, type));
      const EmResult aware = fit_em(PointSet(points, unweighted, none), truth, unfloored(30, type));
      EXPECT_LT(difference(aware, plain), 1e-13 * 30) << features;  // rounding errors over thirty iterations
      EXPECT_NEAR(aware.log_likelihood / plain.log_likelihood, 1.0, 1e-13) << features;
      EXPECT_TRUE(
          near(responsibilities(truth, PointSet(points, unweighted, none)), responsibilities(truth, points), 1e-13));
      EXPECT_TRUE(near(log_density(truth, PointSet(points, unweighted, none)), log_density(truth, points), 1e-12));
    }
}

/// One iteration of Bovy, Hogg & Roweis (2011), eq. 14 to 16, point by point in the points' own coordinates.
EmResult direct_step(const Eigen::MatrixXd& points, const Eigen::MatrixXd& errors, GaussianMixture mixture) {
  const Index F = points.rows(), N = points.cols(), K = mixture.components();
  Eigen::MatrixXd densities(K, N);
  const auto total = [&](Index k, Index i) -> Eigen::MatrixXd {
    return mixture.covariances[k] + errors.col(i).reshaped(F, F);
  };
  for (Index i = 0; i < N; ++i)
    for (Index k = 0; k < K; ++k) {
      const Eigen::MatrixXd T = total(k, i);
      const Eigen::VectorXd d = points.col(i) - mixture.means.col(k);
      const double scale = (2.0 * M_PI * T).determinant();
      densities(k, i) = mixture.weights(k) * std::exp(-0.5 * d.dot(T.ldlt().solve(d))) / std::sqrt(scale);
    }
  GaussianMixture next = mixture;
  for (Index k = 0; k < K; ++k) {
    const Eigen::MatrixXd& covariance = mixture.covariances[k];
    const Eigen::RowVectorXd r = densities.row(k).array() / densities.colwise().sum().array();
    Eigen::MatrixXd expected(F, N), spread = Eigen::MatrixXd::Zero(F, F);
    for (Index i = 0; i < N; ++i) {
      const Eigen::MatrixXd gain = total(k, i).ldlt().solve(covariance).transpose();
      expected.col(i) = mixture.means.col(k) + gain * (points.col(i) - mixture.means.col(k));
      spread += r(i) * (covariance - gain * covariance);
    }
    next.weights(k) = r.mean();
    next.means.col(k) = expected * r.transpose() / r.sum();
    const Eigen::MatrixXd off = expected.colwise() - next.means.col(k);
    Eigen::MatrixXd second = (off * r.asDiagonal() * off.transpose() + spread) / r.sum();
    if (mixture.type == CovarianceType::diagonal) second = Eigen::MatrixXd(second.diagonal().asDiagonal());
    next.covariances[k] = second;
  }
  EmResult result;
  result.mixture = next;
  result.log_likelihood = densities.colwise().sum().array().log().sum();
  return result;
}

TEST(ErrorAware, AStepIsWhatTheFormulaeSay) {
  for (const Index features : {1, 2, 3, 4, 5, 7, 8, 12})
    for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal}) {
      SCOPED_TRACE(features);
      GaussianMixture start = any_mixture(features, 3);
      start.type = type;
      if (type == CovarianceType::diagonal)
        for (Eigen::MatrixXd& covariance : start.covariances)
          covariance = Eigen::MatrixXd(covariance.diagonal().asDiagonal());
      const Eigen::MatrixXd errors = random_errors(features, 150, 0.5, 21);
      const Eigen::MatrixXd points = with_errors(draw(start, 150, 22), errors, 23);
      const PointSet set(points, unweighted, errors);
      const EmResult expected = direct_step(points, errors, start), step = fit_em(set, start, unfloored(1, type));
      EXPECT_LT(difference(step, expected), 1e-11);
      EXPECT_NEAR(log_density(start, set).sum() / expected.log_likelihood, 1.0, 1e-12);
    }
}

TEST(ErrorAware, PointsFarFromEverythingKeepTheirDensity) {
  // Densities relative to one common number would underflow. If all errors are equal, a mixture of inflated components
  // gives the expected values.
  for (const Index features : {2, 6}) {
    const GaussianMixture mixture = any_mixture(features, 3);
    GaussianMixture inflated = mixture;
    const Eigen::MatrixXd error = random_errors(features, 1, 0.8, 3);
    for (Eigen::MatrixXd& covariance : inflated.covariances) covariance += error.reshaped(features, features);
    Eigen::MatrixXd points = draw(inflated, 40, 6);
    points.col(3).array() += 60.0;
    points.col(17).array() -= 1e4;
    const Eigen::MatrixXd errors = error.replicate(1, 40);
    const PointSet set(points, unweighted, errors);
    const Eigen::VectorXd aware = log_density(mixture, set), plain = log_density(inflated, points);
    EXPECT_LT(aware(17), -1e6);
    EXPECT_TRUE(near(aware.cwiseQuotient(plain), Eigen::VectorXd::Ones(40), 1e-10));
    EXPECT_TRUE(near(responsibilities(mixture, set), responsibilities(inflated, points), 1e-9));
  }
}

TEST(ErrorAware, LogLikelihoodNeverFalls) {
  for (const CovarianceType type : {CovarianceType::full, CovarianceType::diagonal}) {
    const Eigen::MatrixXd errors = random_errors(2, 300, 1.0, 7);
    const Eigen::MatrixXd points = with_errors(draw(three_clusters(4.0), 300, 7), errors, 8);
    GaussianMixture mixture = three_clusters(3.0);
    double previous = -std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < 60; ++iteration) {
      const EmResult step = fit_em(PointSet(points, unweighted, errors), mixture, unfloored(1, type));
      ASSERT_FALSE(step.floor_active);
      EXPECT_GE(step.log_likelihood, previous - 1e-11 * std::abs(previous)) << iteration;
      previous = step.log_likelihood;
      mixture = step.mixture;
    }
  }
}

TEST(ErrorAware, ScalesAndThreadsChangeNothing) {
  const Eigen::MatrixXd errors = random_errors(2, 900, 0.7, 11);
  const Eigen::MatrixXd points = with_errors(draw(three_clusters(4.0), 900, 11), errors, 12);
  const Eigen::Array2d unit(1e-6, 1e6);
  const Eigen::MatrixXd scaled = points.array().colwise() * unit;
  const Eigen::Array4d error_unit(unit(0) * unit(0), 1.0, 1.0, unit(1) * unit(1));
  const Eigen::MatrixXd scaled_errors = errors.array().colwise() * error_unit;
  EmOptions options;
  options.restarts = 2;
  const EmResult base = fit_em(PointSet(points, unweighted, errors), 3, options, 1);
  const EmResult other = fit_em(PointSet(scaled, unweighted, scaled_errors), 3, options, 1);
  EXPECT_TRUE(near(other.mixture.means.array().colwise() / unit, base.mixture.means, 1e-7));
  EXPECT_NEAR(other.log_likelihood, base.log_likelihood, 1e-6);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const EmResult alone = fit_em(PointSet(points, unweighted, errors), 3, options, 1);
  EXPECT_EQ(alone.log_likelihood, base.log_likelihood);
  EXPECT_EQ(alone.mixture.covariances, base.mixture.covariances);
}

TEST(ErrorAware, HugeAndSingularErrorsAreSound) {
  for (const Index features : {2, 6}) {
    const GaussianMixture truth = any_mixture(features, 2);
    const Eigen::MatrixXd points = draw(truth, 200, 13);
    Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(features * features, 200);
    errors.row(0).setConstant(1e300);  // an error so large that one feature is unknown
    errors.rightCols(50) = Eigen::VectorXd::Ones(features * features).replicate(1, 50) * 1e200;  // rank one
    const PointSet set(points, unweighted, errors);
    const EmResult fit = fit_em(set, 2, EmOptions(), 1);
    EXPECT_TRUE(is_finite(fit.mixture)) << features;
    EXPECT_TRUE(std::isfinite(fit.log_likelihood));
    EXPECT_TRUE(log_density(fit.mixture, set).allFinite());
    EXPECT_TRUE(near(responsibilities(fit.mixture, set).colwise().sum(), Eigen::RowVectorXd::Ones(200), 1e-14));
  }
}

TEST(ErrorAware, WhatIsNoCovarianceIsRefused) {
  const Eigen::MatrixXd points = draw(three_clusters(3.0), 20, 1);
  const auto refused = [&](auto change) {
    Eigen::MatrixXd errors = random_errors(2, 20, 1.0, 1);
    change(errors);
    EXPECT_THROW(fit_em(PointSet(points, unweighted, errors), 2, EmOptions(), 1), std::invalid_argument);
    EXPECT_THROW(log_density(three_clusters(3.0), PointSet(points, unweighted, errors)), std::invalid_argument);
  };
  refused([](Eigen::MatrixXd& errors) { errors(0, 3) = -1.0; });
  refused([](Eigen::MatrixXd& errors) { errors(3, 3) = std::numeric_limits<double>::quiet_NaN(); });
  refused([](Eigen::MatrixXd& errors) { errors(1, 3) += 1.0; });  // not symmetric
  refused([](Eigen::MatrixXd& errors) { errors.row(1) = errors.row(2) = 2.0 * errors.row(0) + errors.row(3); });
  refused([](Eigen::MatrixXd& errors) { errors.conservativeResize(4, 19); });
  refused([](Eigen::MatrixXd& errors) { errors.conservativeResize(3, 20); });
}

}  // namespace
}  // namespace modebank::test
