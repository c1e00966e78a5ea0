#include "ident/model/residual_tests.hpp"

#include <boost/math/distributions/binomial.hpp>
#include <cmath>

#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using test::near;

MatrixXd white(Index rows, Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal(0.0, 1.0);
  MatrixXd values(rows, samples);
  for (double& value : values.reshaped()) value = normal(generator);
  return values;
}

/// x[k] = phi x[k-1] + white noise.
MatrixXd autoregressive(MatrixXd series, double phi) {
  for (Index k = 1; k < series.cols(); ++k) series.col(k) += phi * series.col(k - 1);
  return series;
}

template <class Outside>
double count(const Outside& outside) {
  return static_cast<double>(outside.count());
}

/// Shares of lags outside the bands over many series. They are compared with the binomial's 1e-4 quantiles, because the
/// lags of one series are nearly independent.
TEST(ResidualTests, OfWhiteNoiseStayInsideTheirBands) {
  constexpr int series = 100;
  double autocorrelation = 0.0, cross = 0.0, small_p = 0.0;
  for (int i = 0; i < series; ++i) {
    const ResidualTests tests = test_residuals(white(1, 2000, 2 * i), white(1, 2000, 2 * i + 1));
    autocorrelation += count(tests.autocorrelation.rightCols(25).array().abs() > tests.autocorrelation_band);
    cross += count(tests.cross_correlation.array().abs() > tests.cross_correlation_band(0, 0));
    small_p += tests.ljung_box_p(0) < 0.05 ? 1 : 0;
  }
  const auto within = [](double count, int of, double share) {
    const boost::math::binomial law(of, share);
    return count >= boost::math::quantile(law, 1e-4) && count <= boost::math::quantile(law, 1 - 1e-4);
  };
  EXPECT_TRUE(within(autocorrelation, series * 25, 0.01)) << autocorrelation;
  EXPECT_TRUE(within(cross, series * 26, 0.01)) << cross;
  EXPECT_TRUE(within(small_p, series, 0.05)) << small_p;
}

/// For two independent autocorrelated series, a band of +- z / sqrt(N) would be much too narrow.
TEST(ResidualTests, CrossCorrelationBandsAllowForAutocorrelation) {
  constexpr int series = 100;
  double outside = 0.0, outside_naive = 0.0;
  for (int i = 0; i < series; ++i) {
    const MatrixXd e = autoregressive(white(1, 2000, 500 + 2 * i), 0.8);
    const ResidualTests tests = test_residuals(e, autoregressive(white(1, 2000, 501 + 2 * i), 0.8));
    outside += count(tests.cross_correlation.array().abs() > tests.cross_correlation_band(0, 0)) / 26 / series;
    outside_naive += count(tests.cross_correlation.array().abs() > tests.autocorrelation_band) / 26 / series;
  }
  EXPECT_LT(outside, 0.025);
  EXPECT_GT(outside_naive, 0.15);
}

TEST(ResidualTests, OfAnAutoregressionArePowersOfPhi) {
  constexpr double phi = 0.7, four_standard_errors = 0.05;  // the standard error is sqrt((1 + phi^2) / (1 - phi^2) / N)
                                                            // = 0.012
  const ResidualTests tests = test_residuals(autoregressive(white(1, 20'000, 3), phi), white(1, 20'000, 4));
  for (Index lag = 0; lag < 10; ++lag)
    EXPECT_NEAR(tests.autocorrelation(0, lag), std::pow(phi, lag), four_standard_errors) << lag;
  EXPECT_LT(tests.ljung_box_p(0), 1e-12);
}

/// The global model of a system whose second input acts two samples late.
TEST(ResidualTests, ShowTheDelayOfAnInputAtItsLag) {
  const MatrixXd u = white(2, 1000, 8), noise = 0.05 * white(1, 1000, 9);
  MatrixXd x = MatrixXd::Zero(1, 1000);
  for (Index k = 0; k + 1 < 1000; ++k)
    x(0, k + 1) = 0.6 * x(0, k) + 0.3 * u(0, k) + (k >= 2 ? 0.5 * u(1, k - 2) : 0.0) + noise(0, k);
  const Trajectory run = test::make_run(x, u);
  const LinearStructure structure{1, 2, false};
  const GlobalModel global = fit_global(test::make_recording({run}), structure);
  const ResidualTests tests = test_residuals(run, structure, global.theta);
  EXPECT_EQ(tests.samples, 999);
  const Eigen::VectorXd late = tests.cross_correlation.row(1).cwiseAbs();
  Index lag = 0;
  EXPECT_GT(late.maxCoeff(&lag), 5 * tests.cross_correlation_band(1, 0));
  EXPECT_EQ(lag, 2);
  EXPECT_LT(late.head(2).maxCoeff(), tests.cross_correlation_band(1, 0));
  // Least squares makes the residuals orthogonal to the regressors; the input's mean is nearly zero.
  EXPECT_LT(std::abs(tests.cross_correlation(0, 0)), 0.01);
}

TEST(ResidualTests, LeaveOutWhatIsMissing) {
  MatrixXd e = autoregressive(white(2, 4000, 12), 0.5);
  const ResidualTests whole = test_residuals(e, white(1, 4000, 13));
  for (Index k = 100; k < 200; ++k) e(0, k) = std::nan("");
  const ResidualTests tests = test_residuals(e, white(1, 4000, 13));
  EXPECT_EQ(tests.samples, 3900);
  EXPECT_TRUE(near(tests.autocorrelation, whole.autocorrelation, 0.02));
  EXPECT_TRUE(near(tests.autocorrelation.row(1), whole.autocorrelation.row(1), 0.0));
}

TEST(ResidualTests, OfConstantAndShortSeriesAreUndefined) {
  MatrixXd input(2, 50);
  input.row(0).setConstant(0.1);
  input.row(1) = white(1, 50, 1);
  const ResidualTests tests = test_residuals(white(1, 50, 2), input);
  EXPECT_TRUE(tests.cross_correlation.row(0).array().isNaN().all());
  EXPECT_TRUE(tests.cross_correlation.row(1).allFinite());
  EXPECT_TRUE(std::isnan(test_residuals(white(1, 4, 2), white(1, 4, 3)).ljung_box_p(0)));
  EXPECT_EQ(test_residuals(white(1, 4, 2), white(1, 4, 3)).autocorrelation.cols(), 4);
  EXPECT_TRUE(test_residuals(MatrixXd::Zero(1, 50), input).autocorrelation.rightCols(10).array().isNaN().all());
  EXPECT_EQ(test_residuals(white(1, 50, 2), MatrixXd(0, 50)).cross_correlation.rows(), 0);
}

TEST(ResidualTests, RefuseSizesThatDoNotFit) {
  EXPECT_THROW(test_residuals(white(1, 50, 1), white(1, 49, 1)), std::invalid_argument);
  EXPECT_THROW(test_residuals(white(1, 50, 1), white(1, 50, 1), {0, 0.99}), std::invalid_argument);
  EXPECT_THROW(test_residuals(white(1, 50, 1), white(1, 50, 1), {25, 1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
