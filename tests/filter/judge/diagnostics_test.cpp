// Diagnostics on simulated data: a correct filter passes, and a wrong filter fails.
#include "filter/judge/diagnostics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::example_bank;
using test::simulate_truth;

std::vector<DiagnosticsRow> diagnose_runs(const Bank& filter_bank, const std::vector<Trajectory>& runs,
                                          const FilterOptions& options = {}) {
  std::vector<RunEvaluation> evaluations;
  for (const Trajectory& run : runs) {
    evaluations.push_back(evaluate_run(filter_bank, run, options));
    evaluations.back().viterbi_mode = mode_sequence(filter_bank, run, options);
  }
  return diagnose("bank", Role::test, filter_bank, filter_bank.mode_count() == 1, runs, evaluations,
                  score_runs(evaluations));
}

std::vector<Trajectory> truth_runs(const Bank& bank, Index runs, Index samples) {
  std::vector<Trajectory> result;
  for (Index i = 0; i < runs; ++i) {
    result.push_back(simulate_truth(bank, samples, 1000 + static_cast<std::uint64_t>(i)).run);
    result.back().role = Role::test;
  }
  return result;
}

bool inside(double value, double lower, double upper) { return value >= lower && value <= upper; }

TEST(Diagnostics, ATrueFilterHasTheMeansOfItsStatesAndAWrongOneHasNot) {
  for (const Index n : {1, 2}) {
    Bank bank = test::single_mode(example_bank(n, 1, 1, 5e-5), 0);  // Q = 1.3e-4
    const std::vector<Trajectory> runs = truth_runs(bank, 4, 1500);
    const DiagnosticsRow right = diagnose_runs(bank, runs).front();
    EXPECT_EQ(right.verdict, Calibration::calibrated);
    const auto states = static_cast<double>(n);
    EXPECT_NEAR(right.nis_mean, states, 0.1);
    EXPECT_NEAR(right.nees_mean, states, 0.15);
    EXPECT_EQ(right.flags, "");
    for (const double factor : {0.25, 4.0})
      for (const bool process : {true, false}) {
        Bank wrong = bank;
        if (process)
          wrong.modes[0].Q *= factor;
        else
          wrong.R *= factor;
        const DiagnosticsRow row = diagnose_runs(wrong, runs).front();
        const std::string what = (process ? "Q x " : "R x ") + std::to_string(factor);
        EXPECT_GT(std::abs(row.nis_mean - right.nis_mean), 0.1 * states) << what;
        EXPECT_GT(std::abs(row.nees_mean - right.nees_mean), 0.03 * states) << what;
        EXPECT_EQ(row.nis_mean > right.nis_mean, factor < 1.0) << what;
      }
  }
}

TEST(Diagnostics, NoNeesWhereTheStateIsTheMeasurement) {
  Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-6), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 800);
  EXPECT_TRUE(std::isfinite(diagnose_runs(bank, runs).front().nees_mean));
  bank.R *= 1e-6;
  const DiagnosticsRow row = diagnose_runs(bank, runs).front();
  EXPECT_TRUE(std::isnan(row.nees_mean));
  EXPECT_NEAR(row.state_rmse(0), 1e-3, 1e-4);
  EXPECT_THAT(row.flags, testing::HasSubstr("no NEES"));
}

/// One of two gyros has no noise, so only the other gyro is judged.
TEST(Diagnostics, NeesIsAboutTheStatesThatAreNotTheMeasurement) {
  Bank bank = test::single_mode(example_bank(2, 1, 1, 1e-4), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 1500);
  bank.R(1, 1) = 1e-13;
  const DiagnosticsRow row = diagnose_runs(bank, runs).front();
  EXPECT_NEAR(row.nees_mean, 1.0, 0.35);  // one degree of freedom; the filter assumes too much noise for the other gyro
  EXPECT_THAT(row.flags, testing::HasSubstr("NEES only of the other states"));
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
    EXPECT_TRUE(inside(0.025, rows[i].too_far_lower, rows[i].too_far_upper)) << "mode " << rows[i].mode;
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
    return diagnose_runs(filter, runs).front().flags;
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
  EXPECT_THAT(diagnose("bank", Role::test, wrong, {}, runs, failed, score_runs(failed)).front().flags,
              testing::HasSubstr("the filter failed at 1 samples"));
}

}  // namespace
}  // namespace modebank
