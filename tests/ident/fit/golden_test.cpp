// Windows compared with statsmodels, scipy and numpy (tests/golden/generate/ident_fits.py).
#include "tests/support/golden.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "modebank/base/eigen.hpp"
#include "modebank/ident/windows.hpp"
#include "tests/ident/public_run.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::golden_rows;
using test::near;

/// Both implementations solve a well-conditioned problem with O(1) entries in double precision.
constexpr double least_squares_tolerance = 1e-12;
/// The golden optima are roots of the estimating equations to about 1e-13; the promised accuracy is 1e-8 relative.
constexpr double statsmodels_tolerance = 1e-10;

struct Fit {
  Eigen::VectorXd theta, global_theta, noise_variance;
  Eigen::MatrixXd covariance;
  int rank = 0;
  FitStatus status = FitStatus::failed;
};

struct GoldenCase {
  explicit GoldenCase(const std::string& name) : json(test::read_golden("ident_fits").at(name)) {
    state = golden_rows(json.at("state"));
    input = golden_rows(json.at("input"));
    sigma = golden_rows(json.at("sigma"));
  }
  Fit fit(Loss loss, FitOptions options = {}) const {
    options.loss = loss;
    options.prior = Prior::none;
    return fit(options, {test::public_run(state, input)});
  }
  /// The window over the whole first run. FitOptions have one sigma, so states are fitted in units of their own sigma.
  Fit fit(FitOptions options, std::vector<RecordedRun> runs) const {
    options.length = state.cols() - 1;
    options.intercept = json.at("intercept").get<bool>();
    options.sigma = 1.0;
    for (RecordedRun& run : runs) run.state = to_matrix(sigma.cwiseInverse().asDiagonal() * view(run.state));
    const ident::Windows windows = ident::fit_windows({runs, {}, {}}, options);
    const Eigen::VectorXd unit = units();
    return {unit.cwiseProduct(view(windows.theta).col(0)),
            unit.cwiseProduct(view(windows.global_theta)),
            sigma.cwiseProduct(view(windows.residual_sd).col(0)).cwiseAbs2(),
            unit.asDiagonal() * view(windows.covariance).col(0).reshaped(unit.size(), unit.size()) * unit.asDiagonal(),
            windows.rank.at(0),
            windows.status.at(0)};
  }
  /// theta's units, if each state is in units of its sigma.
  Eigen::VectorXd units() const {
    const Index n = sigma.size(), q = n + input.rows() + (json.at("intercept").get<bool>() ? 1 : 0);
    Eigen::MatrixXd unit = sigma.transpose().replicate(q, 1);
    unit.topRows(n) = sigma.cwiseInverse().asDiagonal() * unit.topRows(n);
    return unit.reshaped();
  }

  nlohmann::json json;
  Eigen::MatrixXd state, input;
  Eigen::VectorXd sigma;
};

FitOptions sandwich() {
  FitOptions options;
  options.covariance = CovarianceKind::sandwich;
  return options;
}

TEST(LeastSquares, AgreesWithStatsmodels) {
  for (const std::string name : {"single_state", "two_states"}) {
    const GoldenCase c(name);
    const Fit fit = c.fit(Loss::trivial);
    const auto& ols = c.json.at("ols");
    EXPECT_TRUE(near(fit.theta, golden_rows(ols.at("theta")), least_squares_tolerance)) << name;
    EXPECT_TRUE(near(fit.covariance, golden_rows(ols.at("covariance")), least_squares_tolerance)) << name;
    EXPECT_EQ(fit.status, FitStatus::converged);
    EXPECT_EQ(fit.rank, fit.theta.size());
    if (name == "single_state") {
      EXPECT_NEAR(fit.noise_variance(0), ols.at("noise_variance").get<double>(), least_squares_tolerance);
    } else {
      const Eigen::VectorXd standard_error = fit.covariance.diagonal().cwiseSqrt();
      EXPECT_TRUE(near(standard_error, golden_rows(ols.at("standard_error")), least_squares_tolerance));
    }
  }
}

TEST(LeastSquares, Hc3AgreesWithStatsmodels) {
  const GoldenCase c("single_state"), two("two_states");
  const auto agrees = [](const Eigen::MatrixXd& covariance, const nlohmann::json& hc3) {
    EXPECT_TRUE(near(covariance, golden_rows(hc3), least_squares_tolerance));
  };
  agrees(c.fit(Loss::trivial, sandwich()).covariance, c.json.at("ols").at("hc3"));
  const Eigen::MatrixXd covariance = two.fit(Loss::trivial, sandwich()).covariance;
  for (Index i = 0; i < 2; ++i)
    agrees(covariance.block(4 * i, 4 * i, 4, 4), two.json.at("ols").at("hc3").at(static_cast<std::size_t>(i)));
}

/// A held-out run is left out, and so is a transition that is not finite.
TEST(GlobalModel, AgreesWithStatsmodels) {
  for (const std::string name : {"single_state", "two_states"}) {
    const GoldenCase c(name);
    Eigen::MatrixXd state = c.state, input = c.input;
    state.conservativeResize(Eigen::NoChange, state.cols() + 1);
    input.conservativeResize(Eigen::NoChange, input.cols() + 1);
    state.rightCols(1).setConstant(std::nan(""));
    input.rightCols(1).setZero();
    FitOptions options;
    options.prior = Prior::none;
    const Fit fit = c.fit(options, {test::public_run(state, input), test::public_run(2.0 * c.state, c.input, true)});
    EXPECT_TRUE(near(fit.global_theta, golden_rows(c.json.at("ols").at("theta")), least_squares_tolerance)) << name;
  }
}

TEST(Huber, AgreesWithStatsmodelsRlm) {
  GoldenCase c("single_state");
  const auto& rlm = c.json.at("rlm");
  c.sigma(0) = rlm.at("sigma").get<double>();
  const Fit fit = c.fit(Loss::huber);
  EXPECT_TRUE(near(fit.theta, golden_rows(rlm.at("theta")), statsmodels_tolerance));
  EXPECT_TRUE(near(fit.covariance, golden_rows(rlm.at("covariance")), statsmodels_tolerance));
}

TEST(Huber, SeveralStatesHaveTheBlockCovariance) {
  const GoldenCase c("two_states");
  EXPECT_TRUE(near(c.fit(Loss::huber).covariance, golden_rows(c.json.at("huber_covariance")), statsmodels_tolerance));
}

class EveryLoss : public ::testing::TestWithParam<Loss> {};

TEST_P(EveryLoss, ReachesTheIndependentOptimum) {
  for (const std::string name : {"single_state", "two_states"}) {
    const GoldenCase c(name);
    const std::string loss(name_of(GetParam()));
    const Fit fit = c.fit(GetParam());
    EXPECT_TRUE(near(fit.theta, golden_rows(c.json.at("robust").at(loss)), statsmodels_tolerance))
        << name << ", " << loss;
    EXPECT_EQ(fit.status, FitStatus::converged);
  }
}

TEST_P(EveryLoss, DoesNotDependOnTheUnits) {
  const GoldenCase c("two_states");
  const Fit fit = c.fit(GetParam());
  GoldenCase scaled = c;
  constexpr double unit = 1e6;
  scaled.input *= unit;
  const Fit other = scaled.fit(GetParam());
  const Eigen::VectorXd factor{{1, 1, unit, 1, 1, 1, unit, 1}};
  EXPECT_TRUE(near(other.theta.cwiseProduct(factor), fit.theta, statsmodels_tolerance));
  EXPECT_TRUE(
      near(factor.asDiagonal() * other.covariance * factor.asDiagonal(), fit.covariance, statsmodels_tolerance));
}

INSTANTIATE_TEST_SUITE_P(Losses, EveryLoss,
                         ::testing::Values(Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan),
                         [](const auto& instance) { return std::string(name_of(instance.param)); });

TEST(Unexcited, MinimumNormAgreesWithNumpy) {
  GoldenCase c("unexcited");
  c.sigma.setOnes();  // least squares has the same theta for any sigma, but its norm is that of the fitted units
  const Fit fit = c.fit(Loss::trivial);
  EXPECT_TRUE(near(fit.theta, golden_rows(c.json.at("minimum_norm")), least_squares_tolerance));
  EXPECT_EQ(fit.rank, c.json.at("rank").get<int>());
  EXPECT_EQ(fit.status, FitStatus::rank_deficient);
  EXPECT_TRUE(fit.covariance.array().isNaN().all());
  EXPECT_GT(fit.noise_variance(0), 0.0);
}

TEST(Unexcited, PriorGivesThePosterior) {
  const GoldenCase c("unexcited");
  const auto& expected = c.json.at("prior");
  const Eigen::VectorXd mean = golden_rows(expected.at("mean")), sd = golden_rows(expected.at("sd"));
  FitOptions options;
  options.loss = Loss::trivial;
  options.prior_sd = to_vector(sd.cwiseQuotient(c.units()));
  const Fit fit = c.fit(options, {test::public_run(c.state, c.input), test::run_that_decides(mean)});
  ASSERT_TRUE(near(fit.global_theta, mean, least_squares_tolerance));
  EXPECT_TRUE(near(fit.theta, golden_rows(expected.at("theta")), least_squares_tolerance));
  EXPECT_EQ(fit.status, FitStatus::rank_deficient);
  EXPECT_EQ(fit.rank, 2);
  EXPECT_TRUE(fit.covariance.allFinite());
}

}  // namespace
}  // namespace modebank
