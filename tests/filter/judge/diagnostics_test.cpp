// Diagnostics on simulated data: a correct filter passes, and a wrong filter fails.
#include "filter/judge/diagnostics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ident/base/distributions.hpp"
#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::diagnose_runs;
using test::example_bank;
using test::row_of;
using test::simulate_truth;

std::vector<Trajectory> truth_runs(const Bank& bank, Index runs, Index samples) {
  std::vector<Trajectory> result;
  for (Index i = 0; i < runs; ++i) {
    result.push_back(simulate_truth(bank, samples, 1000 + static_cast<std::uint64_t>(i)).run);
    result.back().role = Role::test;
  }
  return result;
}

TEST(Diagnostics, ATrueFilterHasTheMeansOfItsStatesAndAWrongOneHasNot) {
  for (const Index n : {1, 2}) {
    Bank bank = test::single_mode(example_bank(n, 1, 1, 5e-5), 0);  // Q = 1.3e-4
    const std::vector<Trajectory> runs = truth_runs(bank, 4, 1500);
    const DiagnosticsRow right = row_of(bank, runs);
    EXPECT_EQ(right.verdict, Calibration::calibrated);
    const auto states = static_cast<double>(n);
    EXPECT_NEAR(right.nis_mean, states, 0.1);
    EXPECT_NEAR(right.nees_mean, states, 0.15);
    EXPECT_EQ(right.flags, "");
    for (const double factor : {0.25, 4.0}) {
      Bank wrong_R = bank, wrong_Q = bank;
      wrong_R.R *= factor;
      wrong_Q.modes[0].Q *= factor;
      for (const Bank& wrong : {wrong_R, wrong_Q}) {
        const DiagnosticsRow row = row_of(wrong, runs);
        EXPECT_GT(std::abs(row.nis_mean - right.nis_mean), 0.1 * states) << factor << ", R " << wrong.R;
        EXPECT_GT(std::abs(row.nees_mean - right.nees_mean), 0.03 * states) << factor << ", R " << wrong.R;
        EXPECT_EQ(row.nis_mean > right.nis_mean, factor < 1.0) << factor << ", R " << wrong.R;
      }
    }
  }
}

TEST(Diagnostics, NeesIsAboutTheStatesThatAreNotTheMeasurement) {
  Bank bank = test::single_mode(example_bank(2, 1, 1, 1e-4), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 1500);
  bank.R(1, 1) = 1e-13;
  const DiagnosticsRow row = row_of(bank, runs);
  EXPECT_NEAR(row.nees_mean, 1.0, 0.35);  // one degree of freedom; the filter assumes too much noise for the other gyro
  EXPECT_THAT(row.flags, testing::HasSubstr("NEES only of the other states"));
  bank.R(0, 0) = 1e-13;
  const DiagnosticsRow none = row_of(bank, runs);
  EXPECT_TRUE(std::isnan(none.nees_mean));
  EXPECT_NEAR(none.state_rmse(0), 1e-2, 1e-3);
  EXPECT_THAT(none.flags, testing::HasSubstr("no NEES"));
}

TEST(Diagnostics, ASwitchingBankIsCalibratedModeByMode) {
  Bank bank = example_bank(1, 2, 3, 1e-6);
  bank.transition = TransitionMatrix::sticky(3, 0.95);
  const std::vector<Trajectory> runs = truth_runs(bank, 3, 3000);
  const std::vector<DiagnosticsRow> rows = diagnose_runs(bank, runs);
  ASSERT_EQ(rows.size(), 4u);
  double usage = 0.0;
  Index samples = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(rows[i].mode, static_cast<Index>(i) - 1);
    EXPECT_EQ(rows[i].verdict, Calibration::calibrated) << "mode " << rows[i].mode;
    EXPECT_LE(rows[i].too_far_lower, 0.025) << "mode " << rows[i].mode;
    EXPECT_GE(rows[i].too_far_upper, 0.025) << "mode " << rows[i].mode;
    if (i == 0) continue;
    usage += rows[i].usage;
    samples += rows[i].samples;
    EXPECT_NEAR(rows[i].usage, 1.0 / 3.0, 0.1);
    EXPECT_NEAR(rows[i].dwell_model, 20.0, 1e-9);
    EXPECT_GT(rows[i].dwell, 15.0);  // the most probable sequence does not contain the shortest stays
    EXPECT_LT(rows[i].dwell, 40.0);
  }
  EXPECT_NEAR(usage, 1.0, 1e-12);
  EXPECT_EQ(samples, rows[0].samples);
  EXPECT_GT(rows[0].entropy, 0.0);
  EXPECT_LT(rows[0].entropy, 0.5);
}

TEST(Diagnostics, FlagsWhatStandsOut) {
  Bank bank = example_bank(1, 1, 2, 1e-6);
  const auto flags = [&](const Bank& filter, const std::vector<Trajectory>& runs) {
    return row_of(filter, runs).flags;
  };
  // Runs of one mode through a bank of two clearly different modes.
  Bank distinct = bank;
  distinct.modes[1].model.c(0) = 1.0;
  const std::string one = flags(distinct, truth_runs(test::single_mode(bank, 0), 1, 600));
  EXPECT_THAT(one, testing::AllOf(testing::HasSubstr("one mode takes all (0)"), testing::HasSubstr("mode 1 unused"),
                                  testing::Not(testing::HasSubstr("flat"))));
  EXPECT_THAT(flags(test::single_mode(bank, 0), truth_runs(test::single_mode(bank, 0), 1, 120)),
              testing::HasSubstr("too few samples for a verdict"));
  // Modes with equal predictions.
  Bank duplicates = bank;
  duplicates.modes[1] = duplicates.modes[0];
  EXPECT_THAT(flags(duplicates, truth_runs(test::single_mode(bank, 0), 1, 600)),
              testing::HasSubstr("probabilities flat"));
  // A model of the wrong motion.
  Bank wrong = test::single_mode(bank, 0);
  wrong.modes[0].model.A *= 0.1;
  wrong.modes[0].Q *= 4.0;
  EXPECT_THAT(flags(wrong, truth_runs(test::single_mode(bank, 0), 1, 1500)), testing::HasSubstr("not white"));
  // An input that overflows the last prediction.
  std::vector<Trajectory> runs = truth_runs(test::single_mode(bank, 0), 1, 600);
  runs[0].input.setZero();
  runs[0].input(0, 598) = 1e300;
  wrong.modes[0].model.B.setConstant(1e100);
  const std::vector<RunEvaluation> failed{evaluate_run(wrong, runs[0], {})};
  EXPECT_THAT(diagnose("bank", Role::test, wrong, {}, runs, failed, test::score_runs(failed)).front().flags,
              testing::HasSubstr("the filter failed at 1 samples"));
}

SquaredDistances distances_of(const std::vector<double>& values, double degrees = 1.0) {
  return {{values}, {std::vector<double>(values.size(), degrees)}};
}

/// Quantiles of chi-square with 100 degrees of freedom, however spread over samples, are 74.22 and 129.56.
TEST(SquaredDistances, TheIntervalIsThatOfTheSum) {
  SquaredDistances mixed = distances_of(std::vector<double>(20, 1.0));
  mixed.value.push_back(std::vector<double>(20, 4.0));
  mixed.degrees.push_back(std::vector<double>(20, 4.0));
  for (const SquaredDistances& whole : {distances_of(std::vector<double>(25, 1.0), 4.0), mixed}) {
    const Interval interval = whole.mean_interval(4.0, 0.95);
    EXPECT_NEAR(interval.lower, 4.0 * 0.7422, 2e-4);
    EXPECT_NEAR(interval.upper, 4.0 * 1.2956, 2e-4);
  }
}

/// If signals are missing, the plain mean over samples would be about n_y (1 - missing).
TEST(SquaredDistances, ATrueFilterHasMeanNisOfItsSignalsWhateverIsMissing) {
  const Bank bank = test::single_mode(example_bank(3, 1, 1), 0);
  for (const double missing : {0.0, 0.3, 0.7}) {
    std::vector<Trajectory> runs = truth_runs(bank, 2, 6000);
    std::mt19937_64 generator(4);
    std::uniform_real_distribution<double> uniform;
    for (Trajectory& run : runs)
      for (double& value : run.state.rightCols(5999).reshaped())
        if (uniform(generator) < missing) value = std::nan("");
    const DiagnosticsRow row = row_of(bank, runs);
    const double signals = 2.0 * 6000.0 * 3.0 * (1.0 - missing);
    EXPECT_NEAR(row.nis_mean, 3.0, 4.0 * 3.0 * std::sqrt(2.0 / signals)) << missing;
    EXPECT_EQ(row.verdict, Calibration::calibrated) << missing;
  }
}

/// A NIS on the scale of all signals lies outside its region exactly if the original NIS lies outside the region for
/// its own degrees.
TEST(SquaredDistances, NisOfFewerSignalsIsDrawnWhereAllWouldBe) {
  RunEvaluation e;
  const double nan = std::nan("");
  e.pit = Eigen::MatrixXd{{nan, 0.5, 0.5, nan}, {nan, 0.5, nan, 0.5}};
  e.nis = Eigen::Vector4d(nan, 5.0, chi_square_quantile(0.975, 1.0), chi_square_quantile(0.025, 1.0));
  const Eigen::VectorXd drawn = nis_of_all_signals(e);
  EXPECT_TRUE(std::isnan(drawn(0)));
  EXPECT_EQ(drawn(1), 5.0);
  EXPECT_NEAR(drawn(2), chi_square_quantile(0.975, 2.0), 1e-9);
  EXPECT_NEAR(drawn(3), chi_square_quantile(0.025, 2.0), 1e-9);
}

}  // namespace
}  // namespace modebank
