#include "filter/judge/scores.hpp"

#include <gtest/gtest.h>

#include "filter/judge/statistics.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/not_a_number.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/golden.hpp"

namespace modebank {
namespace {

/// Boost.Math compared with scipy; both are accurate to a few units in the last place.
constexpr double special_function_tolerance = 1e-11;
/// Allowed deviation of a simulated fraction from its expectation, in standard deviations. By chance, about one
/// fraction in 16000 is beyond the limit. Seeds are fixed.
constexpr double sigmas = 4.0;

TEST(Calibration, QuantilesAndNormalScoresAgreeWithScipyAndAreClipped) {
  const nlohmann::json expected = test::read_golden("scores");
  for (const auto& row : expected.at("chi_square")) {
    const double value = row.at("value");
    EXPECT_NEAR(chi_square_quantile(row.at("p"), row.at("dof")) / value, 1.0, special_function_tolerance);
  }
  for (const auto& row : expected.at("normal_score"))
    EXPECT_NEAR(normal_score(row.at("pit")), row.at("z").get<double>(), special_function_tolerance);
  EXPECT_EQ(normal_score(0.0), normal_score(1e-15));
  EXPECT_EQ(normal_score(1.0), normal_score(1.0 - 1e-15));
}

/// The values of Ljung & Box's and Fisher's tests: tests/program/golden_test.py.
TEST(Calibration, TestsSkipWhatIsUndefined) {
  EXPECT_TRUE(std::isnan(ljung_box_p({1.0, 2.0, 3.0, 4.0})));
  EXPECT_TRUE(std::isnan(ljung_box_p(std::vector<double>(50, 1.0))));
  EXPECT_EQ(fisher_p({0.03, std::nan(""), 0.4, 0.81}), fisher_p({0.03, 0.4, 0.81}));
  EXPECT_NEAR(fisher_p({0.37}), 0.37, special_function_tolerance);
  EXPECT_TRUE(std::isnan(fisher_p({std::nan("")})));
  EXPECT_TRUE(std::isfinite(fisher_p({0.0, 0.5})));
  EXPECT_DOUBLE_EQ(kolmogorov_distance({0.75, 0.25}), 0.25);
  EXPECT_DOUBLE_EQ(kolmogorov_distance({0.9, 0.8}), 0.8);
  EXPECT_TRUE(std::isnan(kolmogorov_distance({})));
}

/// Scores of the filter `bank` on data that were drawn from `truth`.
SummaryRow score(const Bank& bank, const Bank& truth, Eigen::Index samples, std::uint64_t seed) {
  const std::vector<Trajectory> runs{test::simulate_bank(truth, samples, seed)};
  const std::vector<RunEvaluation> evaluations{evaluate_run(bank, runs[0], {})};
  return summarize("bank", Role::train, runs, evaluations, test::score_runs(evaluations)).back();
}

double binomial_bound(double probability, double count) {
  return sigmas * std::sqrt(probability * (1.0 - probability) / count);
}

void expect_calibrated(const SummaryRow& row, double components) {
  const double N = static_cast<double>(row.samples) * components;
  EXPECT_EQ(row.samples, 19999);
  for (const auto& [share, expected] : {std::pair{row.too_far, 0.025},
                                        {row.too_close, 0.025},
                                        {row.coverage_50, 0.50},
                                        {row.coverage_90, 0.90},
                                        {row.coverage_95, 0.95},
                                        {row.coverage_99, 0.99}})
    EXPECT_NEAR(share, expected, binomial_bound(expected, N));
  EXPECT_LT(row.pit_distance, 1.95 / std::sqrt(N));  // 0.1 % critical value of Kolmogorov's distance
  EXPECT_GT(row.whiteness_p, 1e-3);
}

/// With almost no measurement noise, mixing the modes' estimates is exact. The bank is then the correct filter.
TEST(Summary, TheTrueFilterIsCalibrated) {
  for (const Eigen::Index n : {1, 2}) {
    const double dof = static_cast<double>(n);
    const Bank modes = test::example_bank(n, 1, 3, 1e-10);
    expect_calibrated(score(modes, modes, 20000, 12), dof);
    const Bank truth = test::single_mode(test::example_bank(n, 1, 1), 0);
    const SummaryRow row = score(truth, truth, 20000, 11);
    const double N = static_cast<double>(row.samples);
    expect_calibrated(row, dof);
    EXPECT_NEAR(row.nis_above, 0.025, binomial_bound(0.025, N));
    EXPECT_NEAR(row.nis_below, 0.025, binomial_bound(0.025, N));
    EXPECT_NEAR(row.nis_mean, dof, sigmas * std::sqrt(2.0 * dof / N));
  }
}

/// An evaluation with given innovations (one component). All other scores are standard normal.
RunEvaluation hand_made(const Eigen::RowVectorXd& innovation, const Eigen::VectorXd& log_density) {
  RunEvaluation e;
  e.innovation = innovation;
  e.log_density = log_density;
  e.nis = innovation.transpose().array().square();
  e.pit = Eigen::RowVectorXd::Constant(innovation.size(), 0.5);
  return e;
}

TEST(Summary, CountsScoredSamplesAndPoolsOverThem) {
  const double nan = std::nan("");
  Trajectory a, b, c;
  a.run = "a";
  b.run = "b";
  b.role = Role::test;
  c.run = "c";
  const std::vector<RunEvaluation> evaluations{
      hand_made(Eigen::RowVector4d(nan, 3.0, nan, 1.0), Eigen::Vector4d(nan, -2.0, nan, -1.0)),
      hand_made(Eigen::RowVector2d(nan, 1.0), Eigen::Vector2d(nan, -5.0)),
      hand_made(Eigen::RowVector2d(nan, 2.0), Eigen::Vector2d(nan, -6.0))};
  const auto rows = summarize("baseline", Role::train, {a, b, c}, evaluations, test::score_runs(evaluations));
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0].run + ' ' + rows[1].run + ' ' + rows[2].run, "a c *");
  EXPECT_EQ(rows[2].role, Role::train);
  EXPECT_EQ(rows[2].filter, "baseline");
  EXPECT_EQ(rows[0].samples, 2);
  EXPECT_DOUBLE_EQ(rows[0].log_score, -1.5);
  EXPECT_DOUBLE_EQ(rows[0].rmse(0), std::sqrt(5.0));
  EXPECT_EQ(rows[2].samples, 3);
  EXPECT_DOUBLE_EQ(rows[2].log_score, -3.0);
  EXPECT_DOUBLE_EQ(rows[2].rmse(0), std::sqrt(14.0 / 3.0));
  EXPECT_DOUBLE_EQ(rows[2].nis_mean, 14.0 / 3.0);
  EXPECT_DOUBLE_EQ(rows[2].nis_above, 1.0 / 3.0);  // 9 > 5.02, the 97.5 % quantile of chi-square(1)
  EXPECT_DOUBLE_EQ(rows[2].nis_below, 0.0);
  EXPECT_DOUBLE_EQ(rows[2].too_close, 1.0);  // pit = 0.5 gives z = 0
  EXPECT_DOUBLE_EQ(rows[2].pit_distance, 0.5);
  EXPECT_TRUE(std::isnan(rows[2].whiteness_p));
}

/// The bank lacks an input. The effect of this input appears at lag 0, the lag of the predicted transition.
TEST(InnovationTests, ShowAnInputThatTheBankIgnoresAndLeaveOutMissingMeasurements) {
  const Bank truth = test::example_bank(1, 2, 1);
  Trajectory run = test::simulate_bank(truth, 3000, 5);
  run.state(0, 50) = not_a_number;
  Bank blind = truth;
  blind.modes[0].model.B.col(1).setZero();
  const ResidualTests tests = test_innovations(run, score_run(evaluate_run(blind, run, FilterOptions{})));
  Index row = 0, lag = 0;
  tests.cross_correlation.cwiseAbs().maxCoeff(&row, &lag);
  EXPECT_EQ(row, 1);
  EXPECT_EQ(lag, 0);
  EXPECT_GT(tests.cross_correlation(1, 0), 5 * tests.cross_correlation_band(1, 0));
  EXPECT_EQ(tests.samples, 3000 - 2);
}

TEST(Summary, ARunWithoutScoresIsNaN) {
  const double nan = std::nan("");
  const std::vector<RunEvaluation> evaluations{
      hand_made(Eigen::RowVectorXd::Constant(1, nan), Eigen::VectorXd::Constant(1, nan))};
  const auto rows = summarize("bank", Role::train, {Trajectory{}}, evaluations, test::score_runs(evaluations));
  ASSERT_EQ(rows.size(), 2U);
  for (const SummaryRow& row : rows) {
    EXPECT_EQ(row.samples, 0);
    for (const double score : {row.log_score, row.rmse(0), row.nis_mean, row.nis_above, row.nis_below, row.too_far,
                               row.too_close, row.pit_distance, row.whiteness_p})
      EXPECT_TRUE(std::isnan(score));
  }
}

TEST(Summary, WhitenessIsPooledOverRunsByFisher) {
  const Bank truth = test::example_bank(1, 1, 2);
  std::vector<Trajectory> runs;
  std::vector<RunEvaluation> evaluations;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    runs.push_back(test::simulate_bank(truth, seed == 2 ? 4 : 60, seed));  // the last series is too short for a lag
    evaluations.push_back(evaluate_run(truth, runs.back(), {}));
  }
  const auto rows = summarize("bank", Role::train, runs, evaluations, test::score_runs(evaluations));
  EXPECT_TRUE(std::isnan(rows[2].whiteness_p));
  EXPECT_DOUBLE_EQ(rows[3].whiteness_p, fisher_p({rows[0].whiteness_p, rows[1].whiteness_p}));
  EXPECT_NE(rows[0].whiteness_p, rows[1].whiteness_p);
}

}  // namespace
}  // namespace modebank
