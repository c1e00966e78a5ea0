// Predictions without measurements up to the end of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/horizon.hpp"
#include "filter/judge/scores.hpp"
#include "ident/data/stretch.hpp"
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
using test::stable_theta;
using test::with_paths;
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

TEST(FreeRun, StartsAnewAfterAGapAndSaysWhereItCannot) {
  Bank bank = example_bank(1, 1, 2);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 7);
  run.time_s.tail(18).array() += 2.0 * static_cast<double>(longest_gap_steps);
  const FreeRun all = free_run(bank, run, {}, after(5)), part = free_run(bank, stretch(run, 12, 18), {}, after(5));
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
  Bank bank = test::single_mode(example_bank(1, 1, 1), 0);
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

/// Two modes of one state that differ in everything; T is not symmetric.
Bank two_modes() {
  Bank bank = example_bank(1, 1, 2, 1e-3);
  bank.modes[1].model.A(0, 0) = 0.1;
  bank.modes[1].model.c(0) = 0.3;
  bank.modes[1].Q(0, 0) = 0.01;
  bank.transition = TransitionMatrix(Eigen::Matrix2d{{0.8, 0.2}, {0.4, 0.6}});
  bank.initial_probability << 0.7, 0.3;
  return bank;
}

/// Every sequence of two modes: its probability, and the Gaussian of x `steps` after x[0] ~ N(y, R).
struct Sequences {
  Eigen::ArrayXd probability, mean, variance;

  Sequences(const Bank& bank, const Trajectory& run, Index steps) {
    for (Eigen::ArrayXd* values : {&probability, &mean, &variance}) values->setOnes(Index{1} << steps);
    mean *= run.state(0, 0);
    variance *= bank.R(0, 0);
    for (Index s = 0; s < mean.size(); ++s) {
      Eigen::RowVectorXd row = bank.initial_probability.transpose() * bank.transition.matrix();
      for (Index k = 0; k < steps; ++k) {
        const Index j = (s >> k) & 1;
        const Mode& mode = bank.modes[j];
        const double F = 1.0 + mode.model.A(0, 0);
        probability(s) *= row(j);
        mean(s) = F * mean(s) + mode.model.B(0, 0) * run.input(0, k) + mode.model.c(0);
        variance(s) = F * F * variance(s) + mode.Q(0, 0);
        row = bank.transition.matrix().row(j);
      }
    }
  }
  double average() const { return (probability * mean).sum(); }
  double deviation(double R) const {
    return std::sqrt(R + (probability * (variance + (mean - average()).square())).sum());
  }
  double below(double y, double R) const {
    const auto normal = [](double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); };
    return (probability * ((y - mean) / (variance + R).sqrt()).unaryExpr(normal)).sum();
  }
};

TEST(FreeRun, MomentsAreThoseOfAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  const FreeRun found = free_run(bank, run, {}, after(1));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 1e-9) << k;
    EXPECT_NEAR(found.deviation(0, k), exact.deviation(bank.R(0, 0)), 1e-9) << k;
  }
  // After one step the distribution of each mode is Gaussian, so band and density are exact, too.
  const Sequences exact(bank, run, 1);
  EXPECT_NEAR(exact.below(found.lower(0, 1), bank.R(0, 0)), 0.025, 1e-9);
  EXPECT_NEAR(exact.below(found.upper(0, 1), bank.R(0, 0)), 0.975, 1e-9);
  EXPECT_NEAR(found.pit(0, 1), exact.below(run.state(0, 1), bank.R(0, 0)), 1e-9);
}

TEST(FreeRun, SamplePathsAreDrawnFromAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  constexpr Index paths = 20000;
  const FreeRun found = free_run(with_paths(bank), run, {}, after(1, paths));
  const double R = bank.R(0, 0), of_band = 5.0 * std::sqrt(0.025 / static_cast<double>(paths));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    const double sd = exact.deviation(R);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 5.0 * sd / std::sqrt(static_cast<double>(paths))) << k;
    EXPECT_NEAR(found.deviation(0, k), sd, 0.04 * sd) << k;
    EXPECT_NEAR(exact.below(found.lower(0, k), R), 0.025, of_band) << k;
    EXPECT_NEAR(exact.below(found.upper(0, k), R), 0.975, of_band) << k;
    EXPECT_NEAR(found.pit(0, k), exact.below(run.state(0, k), R), 5.0 * 0.5 / std::sqrt(static_cast<double>(paths)));
  }
  EXPECT_EQ(found.lost_paths, 0);
  const auto mean = [&](std::uint64_t seed) {
    FreeRunOptions options = after(1, 30);
    options.seed = seed;
    return Eigen::MatrixXd(free_run(with_paths(bank), run, {}, options).mean.rightCols(8));
  };
  EXPECT_EQ(mean(1), mean(1));
  EXPECT_NE(mean(1), mean(2));
}

TEST(FreeRun, SaysOfPathsThatLeaveTheFiniteRange) {
  Bank bank = two_modes();
  bank.modes[1].model.A(0, 0) = 1e4;
  bank.transition = TransitionMatrix(Eigen::Matrix2d{{0.9, 0.1}, {0.01, 0.99}});
  const Trajectory run = simulate_bank(two_modes(), 200, 6);
  const FreeRun found = free_run(with_paths(bank), run, {}, after(1, 50));
  EXPECT_EQ(found.lost_paths, 50);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_THAT(found.notes[0], HasSubstr("later predictions are not finite"));
  const Index predicted = (!found.mean.row(0).array().isNaN()).count();
  EXPECT_GT(predicted, 10);
  EXPECT_TRUE(found.mean.middleCols(1, predicted).allFinite());
}

/// State-dependent transitions: mode 1 if x + u is above 0.5. Without noise, the path is that of the piecewise
/// recursion.
TEST(FreeRun, ModesMayFollowStateAndInput) {
  Bank bank = two_modes();
  bank.R.setZero();
  for (Mode& mode : bank.modes) mode.Q.setZero();
  bank.modes[1].model.A(0, 0) = -0.8;
  bank.modes[1].model.c(0) = 0.1;
  bank.modes[0].model.c(0) = 0.1;
  constexpr double steep = 1e6;
  bank.transition_logit = {steep * Eigen::Matrix2d{{0.0, 0.0}, {1.0, 1.0}}, Eigen::Vector2d(0.5, 0.0)};
  const Trajectory run = simulate_bank(two_modes(), 40, 9);
  const FreeRun found = free_run(bank, run, {}, after(1, 5));
  double x = run.state(0, 0);
  Index in_second = 0;
  for (Index k = 1; k < run.samples(); ++k) {
    const int mode = x + run.input(0, k - 1) > 0.5 ? 1 : 0;
    in_second += mode;
    x = bank.modes[mode].model.next(Eigen::VectorXd::Constant(1, x), run.input.col(k - 1))(0);
    EXPECT_NEAR(found.mean(0, k), x, 1e-12) << k;
    EXPECT_EQ(found.mode(k), mode) << k;
  }
  EXPECT_GT(in_second, 3);
  EXPECT_LT(in_second, 36);
}

TEST(FreeRunScores, HaveTheirClosedForms) {
  const double nan = std::nan("");
  std::vector<Trajectory> runs(2);
  runs[0].state = Eigen::RowVectorXd{{9, 1, 2, 3, 4}};
  runs[1].state = Eigen::RowVector2d(0, 10);
  std::vector<FreeRun> predicted(2);
  predicted[0].mean = Eigen::RowVectorXd{{nan, 1, 2, 3, 5}};
  predicted[0].pit = Eigen::RowVectorXd{{nan, 0.5, 0.2, 0.04, 0.999}};
  predicted[1].mean = Eigen::RowVector2d(nan, 8);
  predicted[1].pit = Eigen::RowVector2d(nan, 0.03);
  for (FreeRun& one : predicted) one.log_density = (one.mean.array() * 0.0 - 1.5).matrix().transpose();
  const std::vector<FreeRunRow> rows = summarize_free_runs("bank", runs, predicted, after(1));
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
  EXPECT_DOUBLE_EQ(rows[2].fit(0), 100.0 * (1.0 - std::sqrt(5.0 / 50.0)));  // y = 1 2 3 4 10 with mean 4
}

TEST(FreeRun, MomentsAndPathsAgreeWithLagsAndSeveralStates) {
  LinearStructure s{2, 1, true, 2, 2, 1};
  Bank bank = arx_bank(s, stable_theta(s));
  bank.modes.push_back(bank.modes[0]);
  bank.modes[1].model.B *= -1.0;
  for (Mode& mode : bank.modes) mode.Q *= 0.01;
  bank.R = 1e-3 * Eigen::Matrix2d::Identity();
  bank.transition = TransitionMatrix::sticky(2, 0.8);
  bank.initial_probability = Eigen::Vector2d::Constant(0.5);
  const Trajectory run = any_run(s, 60);
  const FreeRun exact = free_run(bank, run, {}, after(20)),
                drawn = free_run(with_paths(bank), run, {}, after(20, 10000));
  const RunEvaluation filter = evaluate_run(bank, run, {});
  EXPECT_TRUE(near(exact.mean.col(20), filter.prediction.col(20), 1e-12)) << "the first prediction is the filter's";
  EXPECT_NEAR(exact.log_density(20), filter.log_density(20), 1e-10);
  EXPECT_NEAR(exact.pit(0, 20), filter.pit(0, 20), 1e-10);
  const Eigen::ArrayXXd sd = exact.deviation.rightCols(40);
  EXPECT_LT(((drawn.mean - exact.mean).rightCols(40).array() / sd).abs().maxCoeff(), 0.06);
  EXPECT_LT((drawn.deviation.rightCols(40).array() / sd - 1.0).abs().maxCoeff(), 0.05);
  EXPECT_LT((drawn.log_density - exact.log_density).tail(40).cwiseAbs().mean(), 0.1);
}

}  // namespace
}  // namespace modebank
