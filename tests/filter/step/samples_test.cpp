// Live samples: starts, missing signals, uneven times.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::near;
using test::simulate_bank;

constexpr double digits = 1e-12;  // tolerance for two computations of a number of order one in double precision

TEST(Start, IsTheFirstMeasurementWithItsCovariance) {
  const Bank bank = example_bank(3, 2, 2);
  const Trajectory run = simulate_bank(bank, 5, 7);
  const RunEvaluation result = evaluate_run(bank, run, {});
  EXPECT_TRUE(near(result.state.col(0), run.state.col(0), digits));
  EXPECT_TRUE(near(result.covariance.col(0), bank.R.reshaped(), digits));
  EXPECT_TRUE(std::isnan(result.log_density(0)) && std::isnan(result.nis(0)) && std::isnan(result.pit(0, 0)));
}

TEST(Start, WaitsForTheFirstWholeMeasurement) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 20, 8);
  Trajectory tail = run;
  tail.time_s = run.time_s.tail(17).eval();
  tail.state = run.state.rightCols(17).eval();
  tail.input = run.input.rightCols(17).eval();
  run.state.leftCols(2).setConstant(std::nan(""));
  run.state(1, 2) = std::nan("");
  const RunEvaluation late = evaluate_run(bank, run, {}), fresh = evaluate_run(bank, tail, {});
  EXPECT_TRUE(near(late.state.rightCols(17), fresh.state, 0.0));
  EXPECT_TRUE(near(late.log_density.tail(17), fresh.log_density, 0.0));
  EXPECT_TRUE(late.state.leftCols(3).array().isNaN().all());
  EXPECT_TRUE(near(late.mode_probability.col(1), bank.initial_probability, 0.0));
  EXPECT_EQ(log_likelihood(bank, run, {}), log_likelihood(bank, tail, {}));
}

TEST(MissingMeasurement, IsAPredictionOnlyStep) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 10, 9);
  run.state.col(6).setConstant(std::nan(""));
  const RunEvaluation result = evaluate_run(bank, run, {});
  EXPECT_TRUE(near(result.state.col(6), result.prediction.col(6), digits));
  EXPECT_TRUE(near(result.mode_probability.col(6), result.mode_probability_predicted.col(6), digits));
  EXPECT_TRUE(near(result.covariance.col(6) + bank.R.reshaped(), result.innovation_covariance.col(6), digits));
  EXPECT_TRUE(std::isnan(result.log_density(6)) && std::isnan(result.nis(6)));
  EXPECT_TRUE(result.innovation.col(6).array().isNaN().all() && result.pit.col(6).array().isNaN().all());
  EXPECT_TRUE(std::isfinite(result.log_density(7)));
}

/// The bank with a sensor for the signals `rows` only.
Bank measuring(Bank bank, const std::vector<Eigen::Index>& rows) {
  bank.C = bank.C(rows, Eigen::all).eval();
  bank.R = bank.R(rows, rows).eval();
  return bank;
}

TEST(MissingMeasurement, OfSomeSignalsLeavesTheOthers) {
  Bank bank = example_bank(3, 1, 2);
  bank.R(0, 1) = bank.R(1, 0) = 0.4 * bank.R(0, 0);
  for (const FilterVariant variant : {FilterVariant::imm, FilterVariant::salvi2025}) {
    Trajectory run = simulate_bank(bank, 3, 9);
    run.state(1, 2) = std::nan("");
    const RunEvaluation partial = evaluate_run(bank, run, {variant});
    // The same step from the same start, with a sensor that lacks the signal.
    BankFilter filter(bank, {variant}), reduced(measuring(bank, {0, 2}), {variant});
    filter.step(0.0, run.input.col(0), run.state.col(0));
    filter.step(1.0, run.input.col(1), run.state.col(1));
    reduced.step(0.0, run.input.col(0), run.state.col(0)(std::vector<int>{0, 2}));
    reduced.step(1.0, run.input.col(1), run.state.col(1)(std::vector<int>{0, 2}));
    std::vector<double> snapshot = reduced.snapshot();
    constexpr std::size_t state = 2 + 2 * (2 + 3 + 2 + 9) + 2 + 2;  // two numbers, means, covariances, probabilities
    std::copy_n(filter.snapshot().begin(), state, snapshot.begin());
    reduced.restore(snapshot);
    const FilterEstimate& e = reduced.step(2.0, run.input.col(2), run.state.col(2)(std::vector<int>{0, 2}));
    EXPECT_TRUE(near(partial.state.col(2), e.state, digits)) << name_of(variant);
    EXPECT_TRUE(near(partial.covariance.col(2), e.covariance.reshaped(), digits));
    EXPECT_TRUE(near(partial.mode_probability.col(2), e.mode_probability, digits));
    EXPECT_NEAR(partial.log_density(2), e.log_density, digits * 10);
    EXPECT_NEAR(partial.nis(2), e.nis, digits * 10);
    EXPECT_TRUE(near(partial.pit.col(2), Eigen::Vector3d(e.pit(0), std::nan(""), e.pit(1)), digits));
    EXPECT_TRUE(std::isnan(partial.innovation(1, 2)) && !std::isnan(partial.innovation(2, 2)));
  }
}

TEST(TimeSteps, ALongerTimeIsSeveralPredictionsWithTheInputHeld) {
  Bank bank = example_bank(2, 1, 3);
  bank.dt_s = 0.1;
  Trajectory run = simulate_bank(bank, 12, 13), every = run;
  run.time_s *= 0.1;
  // The same run with all times. At two times the measurement is missing, and the input is held.
  every.time_s = run.time_s;
  every.state.middleCols(5, 2).setConstant(std::nan(""));
  every.input.col(5) = every.input.col(6) = every.input.col(4);
  Trajectory gap = run;
  const std::vector<int> kept{0, 1, 2, 3, 4, 7, 8, 9, 10, 11};
  gap.time_s = run.time_s(kept).eval();
  gap.state = run.state(Eigen::all, kept).eval();
  gap.input = run.input(Eigen::all, kept).eval();
  const RunEvaluation filled = evaluate_run(bank, every, {}), short_run = evaluate_run(bank, gap, {});
  EXPECT_TRUE(near(short_run.state.rightCols(5), filled.state.rightCols(5), digits));
  EXPECT_TRUE(near(short_run.log_density.tail(5), filled.log_density.tail(5), digits * 10));
  EXPECT_NEAR(log_likelihood(bank, gap, {}), log_likelihood(bank, every, {}), 1e-10);
}

TEST(TimeSteps, AVeryLongTimeAndOneThatGoesBackAreNewStarts) {
  Bank bank = example_bank(2, 1, 3);
  bank.dt_s = 1.0;
  for (const double jump : {static_cast<double>(longest_gap_steps), -1.5, -100.0}) {
    SCOPED_TRACE(jump);
    Trajectory run = simulate_bank(bank, 12, 13), tail = run;
    run.time_s.tail(5).array() += jump;
    tail.time_s = run.time_s.tail(5).eval();
    tail.state = run.state.rightCols(5).eval();
    tail.input = run.input.rightCols(5).eval();
    const RunEvaluation all = evaluate_run(bank, run, {}), fresh = evaluate_run(bank, tail, {});
    EXPECT_TRUE(std::isnan(all.log_density(7)));
    EXPECT_TRUE(near(all.state.rightCols(5), fresh.state, 0.0));
    EXPECT_TRUE(near(all.log_density.tail(5), fresh.log_density, 0.0));
  }
}

}  // namespace
}  // namespace modebank
