// Transition matrices, and the live filter: unusual banks and samples, starts, missing signals, uneven times.
#include "filter/step/bank_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "filter/judge/evaluate.hpp"
#include "ident/data/stretch.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::example_bank;
using test::near;
using test::simulate_bank;

TEST(BankFilter, RefusesBanksWhoseNumbersAreNone) {
  const std::vector<std::function<void(Bank&)>> spoil = {
      [](Bank& b) { b.modes[1].model.A(0, 0) = std::nan(""); },
      [](Bank& b) { b.modes[0].Q(0, 0) = std::nan(""); },
      [](Bank& b) { b.modes[0].Q(1, 1) = -1.0; },
      [](Bank& b) { b.R(0, 0) = -1e-9; },
      [](Bank& b) { b.C(0, 0) = std::nan(""); },
      [](Bank& b) { b.initial_probability(0) = std::nan(""); },
      [](Bank& b) { b.initial_probability *= 0.4; },
      [](Bank& b) { b.quantum = VectorXd::Ones(3); },
      [](Bank& b) { b.quantum = Eigen::Vector2d(-1.0, 0.0); },
      [](Bank& b) {
        b.quantum = VectorXd::Ones(2);
        b.R(0, 1) = b.R(1, 0) = 1e-5;
      },
  };
  EXPECT_NO_THROW(BankFilter(example_bank(2, 1, 3), {}));
  for (std::size_t i = 0; i < spoil.size(); ++i) {
    Bank bank = example_bank(2, 1, 3);
    spoil[i](bank);
    EXPECT_THROW(BankFilter(bank, {}), std::invalid_argument) << i;
  }
}

TEST(BankFilter, RefusesSamplesOfOtherSizes) {
  filter::BankFilter live(filter::Bank(test::example_description(2, 1, 3)));
  EXPECT_THROW(live.step(0.0, std::vector<double>(2), std::vector<double>(2)), std::invalid_argument);
  EXPECT_THROW(live.step(0.0, std::vector<double>(1), std::vector<double>(3)), std::invalid_argument);
  EXPECT_FALSE(live.started());
}

TEST(BankFilter, AnInputThatIsNoNumberIsTheLastKnownOne) {
  const Bank bank = test::example_bank(2, 1, 3);
  const auto last = [&](double odd) {
    BankFilter filter(bank, {});
    for (int k = 0; k < 20; ++k) {
      const double u = k == 10 ? odd : (k == 9 ? 0.3 : 0.1 * k);
      filter.step(k, VectorXd::Constant(1, u), VectorXd::Constant(2, 0.01 * k));
    }
    return filter.estimate().state;
  };
  EXPECT_EQ(last(std::nan("")), last(0.3));
  EXPECT_EQ(last(INFINITY), last(0.3));
}

TEST(TransitionMatrix, NormalisesRowsWithinTheToleranceAndRejectsOthers) {
  const MatrixXd T{{0.95, 0.05}, {0.10, 0.90}};
  EXPECT_EQ(TransitionMatrix(T).matrix(), T);
  EXPECT_NEAR(TransitionMatrix(MatrixXd{{0.95 + 5e-10, 0.05}, {0.10, 0.90}}).matrix().row(0).sum(), 1.0, 1e-15);
  for (const MatrixXd& bad :
       {MatrixXd(MatrixXd::Constant(2, 3, 1.0 / 3.0)), MatrixXd(0, 0), MatrixXd(MatrixXd::Constant(2, 2, 0.5 + 1e-8)),
        MatrixXd{{1.1, -0.1}, {0.5, 0.5}}, MatrixXd(MatrixXd::Constant(1, 1, std::nan(""))), MatrixXd(T.transpose())})
    EXPECT_THROW(TransitionMatrix{bad}, std::invalid_argument) << bad;
}

TEST(TransitionMatrix, StickySpreadsTheRestEqually) {
  const MatrixXd expected{{0.9, 0.05, 0.05}, {0.05, 0.9, 0.05}, {0.05, 0.05, 0.9}};
  EXPECT_TRUE(test::near(TransitionMatrix::sticky(3, 0.9).matrix(), expected, 1e-15));
  EXPECT_EQ(TransitionMatrix::sticky(1, 0.3).matrix()(0, 0), 1.0);
  EXPECT_THROW(TransitionMatrix::sticky(0, 0.9), std::invalid_argument);
  EXPECT_THROW(TransitionMatrix::sticky(2, 1.1), std::invalid_argument);
}

constexpr double digits = 1e-12;  // tolerance for two computations of a number of order one in double precision

TEST(Start, WaitsForTheFirstWholeMeasurement) {
  const Bank bank = example_bank(2, 1, 2);
  Trajectory run = simulate_bank(bank, 20, 8);
  const Trajectory tail = stretch(run, 3, 17);
  run.state.leftCols(2).setConstant(std::nan(""));
  run.state(1, 2) = std::nan("");
  const RunEvaluation late = evaluate_run(bank, run, {}), fresh = evaluate_run(bank, tail, {});
  EXPECT_TRUE(near(late.state.rightCols(17), fresh.state, 0.0));
  EXPECT_TRUE(near(late.log_density.tail(17), fresh.log_density, 0.0));
  EXPECT_TRUE(late.state.leftCols(3).array().isNaN().all());
  EXPECT_TRUE(near(late.mode_probability.col(1), bank.initial_probability, 0.0));
  EXPECT_EQ(log_likelihood(bank, run, {}), log_likelihood(bank, tail, {}));
}

TEST(TimeSteps, ALongerTimeIsSeveralPredictionsWithTheInputHeld) {
  Bank bank = example_bank(2, 1, 3);
  bank.dt_s = 0.1;
  Trajectory every = simulate_bank(bank, 12, 13), gap = every;
  every.time_s *= 0.1;  // at two times the measurement is missing, and the input is held
  every.state.middleCols(5, 2).setConstant(std::nan(""));
  every.input.col(5) = every.input.col(6) = every.input.col(4);
  const std::vector<int> kept{0, 1, 2, 3, 4, 7, 8, 9, 10, 11};
  gap.time_s = every.time_s(kept);
  gap.state = every.state(Eigen::all, kept);
  gap.input = every.input(Eigen::all, kept);
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
    Trajectory run = simulate_bank(bank, 12, 13);
    run.time_s.tail(5).array() += jump;
    const RunEvaluation all = evaluate_run(bank, run, {}), fresh = evaluate_run(bank, stretch(run, 7, 5), {});
    EXPECT_TRUE(std::isnan(all.log_density(7)));
    EXPECT_TRUE(near(all.state.rightCols(5), fresh.state, 0.0));
    EXPECT_TRUE(near(all.log_density.tail(5), fresh.log_density, 0.0));
  }
}

}  // namespace
}  // namespace modebank
