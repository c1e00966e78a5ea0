#include "ident/fit/fit_window.hpp"
#include "ident/fit/global_model.hpp"
#include "modebank/base/error.hpp"
#include "tests/ident/ident_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::golden_fit;
using test::golden_rows;
using test::near;

/// Both implementations solve a well-conditioned problem with O(1) entries in double precision.
constexpr double least_squares_tolerance = 1e-12;
/// The golden optima are roots of the estimating equations to about 1e-13; the promised accuracy is 1e-8 relative.
constexpr double statsmodels_tolerance = 1e-10;

struct GoldenCase {
  explicit GoldenCase(const std::string& name) : json(golden_fit(name)) {
    run = test::make_run(golden_rows(json.at("state")), golden_rows(json.at("input")));
    structure = {run.state.rows(), run.input.rows(), json.at("intercept").get<bool>()};
    sigma = golden_rows(json.at("sigma"));
  }
  LocalModel fit(const FitOptions& options, const ParameterPrior* prior = nullptr) const {
    return fit_window(run, 0, structure, options, sigma, prior);
  }

  nlohmann::json json;
  Trajectory run;
  LinearStructure structure;
  Eigen::VectorXd sigma;
};

TEST(LeastSquares, AgreesWithStatsmodels) {
  const GoldenCase c("single_state");
  const LocalModel fit = c.fit(test::whole_run(c.run, Loss::trivial));
  const auto& ols = c.json.at("ols");
  EXPECT_TRUE(near(fit.theta, golden_rows(ols.at("theta")), least_squares_tolerance));
  EXPECT_TRUE(near(fit.covariance, golden_rows(ols.at("covariance")), least_squares_tolerance));
  EXPECT_NEAR(fit.noise_variance(0), ols.at("noise_variance").get<double>(), least_squares_tolerance);
  EXPECT_EQ(fit.status, FitStatus::converged);
  EXPECT_EQ(fit.rank, 3);
  EXPECT_EQ(fit.inlier_fraction, 1.0);
}

TEST(LeastSquares, Hc3AgreesWithStatsmodels) {
  const GoldenCase c("single_state");
  FitOptions options = test::whole_run(c.run, Loss::trivial);
  options.covariance = CovarianceKind::sandwich;
  EXPECT_TRUE(near(c.fit(options).covariance, golden_rows(c.json.at("ols").at("hc3")), least_squares_tolerance));
}

TEST(LeastSquares, SeveralStatesWithInterceptAgreeWithStatsmodels) {
  const GoldenCase c("two_states");
  FitOptions options = test::whole_run(c.run, Loss::trivial);
  const LocalModel fit = c.fit(options);
  const auto& ols = c.json.at("ols");
  EXPECT_TRUE(near(fit.theta, golden_rows(ols.at("theta")), least_squares_tolerance));
  EXPECT_TRUE(near(fit.covariance, golden_rows(ols.at("covariance")), least_squares_tolerance));
  EXPECT_TRUE(
      near(fit.covariance.diagonal().cwiseSqrt(), golden_rows(ols.at("standard_error")), least_squares_tolerance));
  EXPECT_EQ(fit.rank, 8);
  options.covariance = CovarianceKind::sandwich;
  const LocalModel sandwich = c.fit(options);
  for (Index i = 0; i < 2; ++i)
    EXPECT_TRUE(near(sandwich.covariance.block(4 * i, 4 * i, 4, 4),
                     golden_rows(ols.at("hc3").at(static_cast<std::size_t>(i))), least_squares_tolerance))
        << "state " << i;
}

TEST(GlobalModel, AgreesWithStatsmodels) {
  for (const std::string name : {"single_state", "two_states"}) {
    const GoldenCase c(name);
    Trajectory test_run = c.run;  // a held-out run, which must be ignored
    test_run.role = Role::test;
    test_run.state *= 2.0;
    const GlobalModel global = fit_global(test::make_recording({c.run, test_run}), c.structure);
    const auto& ols = c.json.at("ols");
    EXPECT_TRUE(near(global.theta, golden_rows(ols.at("theta")), least_squares_tolerance)) << name;
    EXPECT_TRUE(near(global.covariance, golden_rows(ols.at("covariance")), least_squares_tolerance)) << name;
    EXPECT_EQ(global.transitions, c.run.transitions());
  }
  const GoldenCase c("single_state");
  const GlobalModel global = fit_global(test::make_recording({c.run}), c.structure);
  EXPECT_NEAR(global.noise_variance()(0), c.json.at("ols").at("population_variance").get<double>(),
              least_squares_tolerance);
}

TEST(GlobalModel, LeavesOutTransitionsThatAreNotFinite) {
  const GoldenCase c("single_state");
  Trajectory longer = c.run;
  const Index N = c.run.samples();
  longer.state.conservativeResize(1, N + 1);
  longer.input.conservativeResize(2, N + 1);
  longer.state(0, N) = std::nan("");
  longer.input.col(N).setZero();
  const GlobalModel global = fit_global(test::make_recording({longer}), c.structure);
  EXPECT_EQ(global.transitions, N - 1);
  EXPECT_TRUE(near(global.theta, golden_rows(c.json.at("ols").at("theta")), least_squares_tolerance));
}

TEST(GlobalModel, WithoutTransitionsIsADataError) {
  EXPECT_THROW(
      fit_global(test::make_recording({test::make_run(Eigen::MatrixXd(1, 1), Eigen::MatrixXd(2, 1))}), {1, 2, false}),
      DataError);
}

TEST(Huber, AgreesWithStatsmodelsRlm) {
  GoldenCase c("single_state");
  const auto& rlm = c.json.at("rlm");
  c.sigma(0) = rlm.at("sigma").get<double>();
  const LocalModel fit = c.fit(test::whole_run(c.run, Loss::huber));
  EXPECT_TRUE(near(fit.theta, golden_rows(rlm.at("theta")), statsmodels_tolerance));
  EXPECT_TRUE(near(fit.covariance, golden_rows(rlm.at("covariance")), statsmodels_tolerance));
}

TEST(Huber, SeveralStatesHaveTheBlockCovariance) {
  const GoldenCase c("two_states");
  const LocalModel fit = c.fit(test::whole_run(c.run, Loss::huber));
  EXPECT_TRUE(near(fit.covariance, golden_rows(c.json.at("huber_covariance")), statsmodels_tolerance));
}

class EveryLoss : public ::testing::TestWithParam<Loss> {};

TEST_P(EveryLoss, ReachesTheIndependentOptimum) {
  for (const std::string name : {"single_state", "two_states"}) {
    const GoldenCase c(name);
    const std::string loss(name_of(GetParam()));
    const LocalModel fit = c.fit(test::whole_run(c.run, GetParam()));
    EXPECT_TRUE(near(fit.theta, golden_rows(c.json.at("robust").at(loss)), statsmodels_tolerance))
        << name << ", " << loss;
    EXPECT_EQ(fit.status, FitStatus::converged);
    EXPECT_LT(fit.inlier_fraction, 1.0);
  }
}

TEST_P(EveryLoss, DoesNotDependOnTheUnits) {
  const GoldenCase c("two_states");
  const LocalModel fit = c.fit(test::whole_run(c.run, GetParam()));
  GoldenCase scaled = c;
  constexpr double unit = 1e6;
  scaled.run.input *= unit;
  const LocalModel other = scaled.fit(test::whole_run(scaled.run, GetParam()));
  const Eigen::VectorXd factor{{1, 1, unit, 1, 1, 1, unit, 1}};
  EXPECT_TRUE(near(other.theta.cwiseProduct(factor), fit.theta, statsmodels_tolerance));
  EXPECT_TRUE(
      near(factor.asDiagonal() * other.covariance * factor.asDiagonal(), fit.covariance, statsmodels_tolerance));
  EXPECT_NEAR(other.condition, fit.condition, statsmodels_tolerance * fit.condition);
}

INSTANTIATE_TEST_SUITE_P(Losses, EveryLoss,
                         ::testing::Values(Loss::huber, Loss::cauchy, Loss::softlone, Loss::tukey, Loss::arctan),
                         [](const auto& instance) { return std::string(name_of(instance.param)); });

TEST(Unexcited, MinimumNormAgreesWithNumpy) {
  const GoldenCase c("unexcited");
  const LocalModel fit = c.fit(test::whole_run(c.run, Loss::trivial));
  EXPECT_TRUE(near(fit.theta, golden_rows(c.json.at("minimum_norm")), least_squares_tolerance));
  EXPECT_EQ(fit.rank, c.json.at("rank").get<Index>());
  EXPECT_EQ(fit.status, FitStatus::rank_deficient);
  EXPECT_TRUE(fit.covariance.array().isNaN().all());
  EXPECT_TRUE(fit.information.array().isNaN().all());
  EXPECT_GT(fit.condition, 1e6);
  EXPECT_GT(fit.noise_variance(0), 0.0);
}

TEST(Unexcited, PriorGivesThePosterior) {
  const GoldenCase c("unexcited");
  const auto& expected = c.json.at("prior");
  const ParameterPrior prior{golden_rows(expected.at("mean")), golden_rows(expected.at("sd"))};
  const LocalModel fit = c.fit(test::whole_run(c.run, Loss::trivial), &prior);
  EXPECT_TRUE(near(fit.theta, golden_rows(expected.at("theta")), least_squares_tolerance));
  EXPECT_EQ(fit.status, FitStatus::rank_deficient);
  EXPECT_EQ(fit.rank, 2);
  EXPECT_TRUE(fit.covariance.allFinite());
  EXPECT_TRUE(near(fit.information, 1.0 - fit.covariance.diagonal().array() / prior.sd.array().square(),
                   least_squares_tolerance));
}

}  // namespace
}  // namespace modebank
