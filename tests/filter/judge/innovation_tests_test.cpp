#include <gtest/gtest.h>

#include "filter/judge/score/statistics.hpp"
#include "ident/base/not_a_number.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

constexpr Index white_samples = 3000;

TEST(InnovationTests, OfTheTrueFilterStayInsideTheirBands) {
  const Bank bank = test::example_bank(1, 2, 1);
  const Trajectory run = test::simulate_bank(bank, white_samples, 4);
  const ResidualTests tests = test_innovations(run, score_run(evaluate_run(bank, run, FilterOptions{})));
  EXPECT_EQ(tests.samples, white_samples - 1) << "the first sample has no prediction";
  EXPECT_LE((tests.autocorrelation.rightCols(25).array().abs() > tests.autocorrelation_band).count(), 2);
  EXPECT_LE((tests.cross_correlation.array().abs() > tests.cross_correlation_band.array().replicate(1, 26)).count(), 4);
  EXPECT_GT(tests.ljung_box_p(0), 1e-3);
}

/// The bank lacks an input. The effect of this input appears at lag 0, the lag of the predicted transition.
TEST(InnovationTests, ShowAnInputThatTheBankIgnores) {
  const Bank truth = test::example_bank(1, 2, 1);
  const Trajectory run = test::simulate_bank(truth, white_samples, 5);
  Bank blind = truth;
  blind.modes[0].model.B.col(1).setZero();
  const ResidualTests tests = test_innovations(run, score_run(evaluate_run(blind, run, FilterOptions{})));
  Index row = 0, lag = 0;
  tests.cross_correlation.cwiseAbs().maxCoeff(&row, &lag);
  EXPECT_EQ(row, 1);
  EXPECT_EQ(lag, 0);
  EXPECT_GT(tests.cross_correlation(1, 0), 5 * tests.cross_correlation_band(1, 0));
}

TEST(InnovationTests, LeaveOutMissingMeasurements) {
  const Bank bank = test::example_bank(1, 2, 1);
  Trajectory run = test::simulate_bank(bank, white_samples, 6);
  run.state(0, 50) = not_a_number;
  EXPECT_EQ(test_innovations(run, score_run(evaluate_run(bank, run, FilterOptions{}))).samples, white_samples - 2);
}

}  // namespace
}  // namespace modebank
