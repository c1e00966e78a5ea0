// Predictions without measurements up to the end of a run.
#include "filter/judge/free_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::after;
using test::any_run;
using test::arx_bank;
using test::example_bank;
using test::near;
using test::simulate_bank;
using test::single_mode;
using test::stable_theta;
using ::testing::HasSubstr;

/// Computes x[k+1] = x[k] + sum A_i x[k+1-i] + sum B_j u[k+1-d-j] + c from theta, after n measured samples.
Eigen::MatrixXd arx_recursion(const LinearStructure& s, const Eigen::VectorXd& theta, const Trajectory& run, Index n) {
  Eigen::MatrixXd x = run.state;
  for (Index k = n; k < x.cols(); ++k)
    for (Index i = 0; i < s.states; ++i) {
      Index p = i * s.regressors();
      double next = x(i, k - 1);
      for (Index lag = 1; lag <= s.state_lags; ++lag)
        for (Index j = 0; j < s.states; ++j) next += theta(p++) * x(j, k - lag);
      for (Index lag = 0; lag < s.input_lags; ++lag)
        for (Index j = 0; j < s.inputs; ++j) next += theta(p++) * run.input(j, k - s.input_delay[j] - lag);
      if (s.intercept) next += theta(p);
      x(i, k) = next;
    }
  x.leftCols(n).setConstant(std::nan(""));
  return x;
}

TEST(FreeRun, OneModeIsThePlainRecursion) {
  const LinearStructure structures[]{{1, 1, true},
                                     {2, 2, true},
                                     {1, 1, true, 3, 3, 0},
                                     {2, 1, false, 2, 3, 2},
                                     {1, 2, true, 2, 2, InputDelays({4, 1})}};
  for (const LinearStructure& s : structures) {
    const Eigen::VectorXd theta = stable_theta(s);
    const Bank bank = arx_bank(s, theta);
    const Trajectory run = any_run(s, 120);
    const Eigen::MatrixXd expected = arx_recursion(s, theta, run, 8);
    const FreeRun found = free_run(bank, run, {}, after(8));
    EXPECT_TRUE(near(found.mean, expected, 1e-12)) << s.state_lags;
    EXPECT_TRUE(found.notes.empty());
  }
}

TEST(FreeRun, DriftingCoefficientsThatDoNotDriftAreThePlainRecursion) {
  Bank model = test::example_drifting(2, 1, 2);
  model.drift.rates = {0.0, 0.0, 0.97};
  const Trajectory run = any_run(model.structure, 80);
  EXPECT_TRUE(
      near(free_run(model, run, {}, after(5)).mean, arx_recursion(model.structure, model.theta(0), run, 5), 1e-12));
}

TEST(FreeRun, FirstPredictionIsTheFilters) {
  const Bank bank = example_bank(2, 1, 3);
  const Trajectory run = simulate_bank(bank, 30, 4);
  const RunEvaluation filter = evaluate_run(bank, run, {});
  const FreeRun found = free_run(bank, run, {}, after(20));
  EXPECT_TRUE(near(found.mean.col(20), bank.C * filter.prediction.col(20), 1e-12));
  EXPECT_NEAR(found.log_density(20), filter.log_density(20), 1e-10);
  EXPECT_NEAR(found.pit(0, 20), filter.pit(0, 20), 1e-10);
}

TEST(FreeRun, StartsAnewAfterAGapAndSaysWhereItCannot) {
  Bank bank = example_bank(1, 1, 2);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 7);
  run.time_s.tail(18).array() += 2.0 * static_cast<double>(longest_gap_steps);
  Trajectory tail = run;
  tail.time_s = run.time_s.tail(18).eval();
  tail.state = run.state.rightCols(18).eval();
  tail.input = run.input.rightCols(18).eval();
  const FreeRun all = free_run(bank, run, {}, after(5)), part = free_run(bank, tail, {}, after(5));
  EXPECT_TRUE(near(all.mean.rightCols(18), part.mean, 0.0));
  EXPECT_TRUE(std::isnan(all.mean(0, 16)) && !std::isnan(all.mean(0, 11)));
  const FreeRun little = free_run(bank, run, {}, after(15));
  ASSERT_EQ(little.notes.size(), 1u);
  EXPECT_EQ(little.notes[0],
            "has 12 samples from sample 0 on, of which 15 are used as measured: no sample is left to predict");
  EXPECT_FALSE(std::isnan(little.mean(0, 29)));
  run.state.leftCols(5).setConstant(std::nan(""));
  EXPECT_THAT(free_run(bank, run, {}, after(4)).notes.at(0), HasSubstr("too few complete measurements"));
  EXPECT_THROW(free_run(arx_bank({1, 1, false, 4, 1, 1}, stable_theta({1, 1, false, 4, 1, 1})), run, {}, after(3)),
               std::invalid_argument);
}

TEST(FreeRun, PredictsThroughGapsAndMissingSamples) {
  Bank bank = single_mode(example_bank(1, 1, 1), 0);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 20, 8);
  run.time_s.tail(10).array() += 3.0;  // adds three model steps, with the input held
  run.state(0, 15) = std::nan("");
  const FreeRun found = free_run(bank, run, {}, after(4));
  double x = found.mean(0, 9);
  for (int i = 0; i < 4; ++i) x = bank.modes[0].model.next(Eigen::VectorXd::Constant(1, x), run.input.col(9))(0);
  EXPECT_NEAR(found.mean(0, 10), x, 1e-12);
  EXPECT_FALSE(std::isnan(found.mean(0, 15)));
  EXPECT_TRUE(std::isnan(found.log_density(15)) && std::isnan(found.pit(0, 15)));
}

TEST(FreeRunScores, HaveTheirClosedForms) {
  Trajectory a, b;
  a.run = "a";
  a.state = (Eigen::RowVectorXd(5) << 9, 1, 2, 3, 4).finished();
  b.run = "b";
  b.state = (Eigen::RowVectorXd(2) << 0, 10).finished();
  for (Trajectory* run : {&a, &b}) run->input = Eigen::MatrixXd::Zero(1, run->state.cols());
  const auto predicted = [](const Eigen::RowVectorXd& mean, const Eigen::RowVectorXd& pit) {
    FreeRun result;
    result.mean = mean;
    result.pit = pit;
    result.log_density = (mean.array() * 0.0 - 1.5).matrix().transpose();
    return result;
  };
  const double nan = std::nan("");
  const std::vector<FreeRun> runs{
      predicted((Eigen::RowVectorXd(5) << nan, 1, 2, 3, 5).finished(),
                (Eigen::RowVectorXd(5) << nan, 0.5, 0.2, 0.04, 0.999).finished()),
      predicted((Eigen::RowVectorXd(2) << nan, 8).finished(), (Eigen::RowVectorXd(2) << nan, 0.03).finished())};
  const std::vector<FreeRunRow> rows = summarize_free_runs("bank", {a, b}, runs, after(1));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].samples, 4);
  EXPECT_EQ(rows[0].start, 1);
  EXPECT_DOUBLE_EQ(rows[0].log_score, -1.5);
  EXPECT_DOUBLE_EQ(rows[0].rmse(0), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].nrmse(0), 0.5 / std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(rows[0].fit(0), 100.0 * (1.0 - 1.0 / std::sqrt(5.0)));  // ||y - yhat|| = 1, ||y - 2.5|| = sqrt 5
  EXPECT_DOUBLE_EQ(rows[0].coverage_50(0), 0.25);
  EXPECT_DOUBLE_EQ(rows[0].coverage_90(0), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].coverage_95(0), 0.75);
  EXPECT_DOUBLE_EQ(rows[0].coverage_99(0), 0.75);
  EXPECT_TRUE(std::isnan(rows[1].nrmse(0)));  // undefined for a run of one sample
  EXPECT_EQ(rows[2].run, "*");
  EXPECT_DOUBLE_EQ(rows[2].rmse(0), 1.0);
  EXPECT_DOUBLE_EQ(rows[2].fit(0), 100.0 * (1.0 - std::sqrt(5.0 / 50.0)));  // y = 1 2 3 4 10 with mean 4
  EXPECT_DOUBLE_EQ(rows[2].coverage_95(0), 0.8);
}

}  // namespace
}  // namespace modebank
