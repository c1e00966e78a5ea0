// Diagnostics on simulated truth: a true filter passes, a wrong one does not.
#include "filter/diagnostics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "filter/smoother.hpp"
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
    smooth_run(filter_bank, run, options, evaluations.back());
  }
  return diagnose("bank", filter_bank, options, runs, evaluations);
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

TEST(Diagnostics, ATrueFilterIsInsideItsBoundsAndAWrongOneIsNot) {
  for (const Index n : {1, 2}) {
    Bank bank = test::single_mode(example_bank(n, 1, 1, 5e-5), 0);  // Q = 1.3e-4
    const std::vector<Trajectory> runs = truth_runs(bank, 4, 1500);
    const DiagnosticsRow right = diagnose_runs(bank, runs).front();
    EXPECT_TRUE(inside(right.nis_mean, right.nis_lower, right.nis_upper)) << right.nis_mean;
    EXPECT_TRUE(inside(right.nees_mean, right.nees_lower, right.nees_upper)) << right.nees_mean;
    EXPECT_EQ(right.verdict, Verdict::calibrated);
    EXPECT_NEAR(right.nis_mean, static_cast<double>(n), 0.1);
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
        EXPECT_FALSE(inside(row.nis_mean, row.nis_lower, row.nis_upper)) << what << ": " << row.nis_mean;
        EXPECT_FALSE(inside(row.nees_mean, row.nees_lower, row.nees_upper)) << what << ": " << row.nees_mean;
        EXPECT_EQ(row.nis_mean > right.nis_mean, factor < 1.0) << what;
      }
  }
}

TEST(Diagnostics, VerdictsNameTheDirection) {
  const Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-6), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 1500);
  for (const auto& [factor, verdict] : {std::pair(1.0, Verdict::calibrated), std::pair(0.25, Verdict::overconfident),
                                        std::pair(4.0, Verdict::underconfident)}) {
    Bank scaled = bank;
    scaled.modes[0].Q *= factor;
    EXPECT_EQ(diagnose_runs(scaled, runs).front().verdict, verdict) << factor;
  }
}

TEST(Diagnostics, FewSamplesAllowNoVerdictUnlessTheyArePlain) {
  const Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-6), 0);
  const DiagnosticsRow few = diagnose_runs(bank, truth_runs(bank, 1, 120)).front();
  EXPECT_EQ(few.verdict, Verdict::undecided);
  EXPECT_THAT(few.flags, testing::HasSubstr("too few samples for a verdict"));
  Bank narrow = bank;
  narrow.modes[0].Q *= 0.05;
  EXPECT_EQ(diagnose_runs(narrow, truth_runs(bank, 1, 120)).front().verdict, Verdict::overconfident);
}

TEST(Diagnostics, NisSpeaksWhereTheTailsDoNot) {
  const Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-6), 0);
  std::vector<Trajectory> runs = truth_runs(bank, 1, 800);
  std::vector<RunEvaluation> evaluations{evaluate_run(bank, runs[0], {})};
  EXPECT_EQ(diagnose("bank", bank, {}, runs, evaluations).front().verdict, Verdict::calibrated);
  evaluations[0].nis *= 0.5;
  const DiagnosticsRow row = diagnose("bank", bank, {}, runs, evaluations).front();
  EXPECT_EQ(row.verdict, Verdict::underconfident);
  EXPECT_THAT(row.flags, testing::HasSubstr("mean NIS below a true filter's"));
}

/// How many of `seeds` simulated runs get each verdict, by a filter whose Q and R are wrong by a factor.
std::map<Verdict, int> verdicts(const Bank& truth, double of_Q, double of_R, Index samples, int seeds,
                                FilterNoise noise = FilterNoise::gaussian) {
  Bank filter = truth;
  for (Mode& mode : filter.modes) mode.Q *= of_Q;
  filter.R *= of_R;
  const FilterOptions options{.noise = noise};
  std::map<Verdict, int> counts;
  for (int seed = 0; seed < seeds; ++seed) {
    std::vector<Trajectory> runs{simulate_truth(truth, samples, 7000 + static_cast<std::uint64_t>(seed)).run};
    runs[0].role = Role::test;
    const std::vector<RunEvaluation> evaluations{evaluate_run(filter, runs[0], options)};
    ++counts[diagnose("bank", filter, options, runs, evaluations).front().verdict];
  }
  return counts;
}

TEST(Diagnostics, VerdictsAreRightSeedBySeed) {
  constexpr int seeds = 40, nearly_all = 38;
  for (const double r : {1e-8, 1.3e-4, 1.3e-3}) {  // Q = 1.3e-4
    const Bank bank = test::single_mode(example_bank(1, 1, 1, r), 0);
    EXPECT_GE(verdicts(bank, 1, 1, 1500, seeds)[Verdict::calibrated], nearly_all) << r;
    std::map<Verdict, int> few = verdicts(bank, 1, 1, 30, seeds);
    EXPECT_GE(few[Verdict::undecided] + few[Verdict::calibrated], nearly_all) << r;
    if (r < 1e-3) {  // under ten times as much R, Q hardly shows
      EXPECT_GE(verdicts(bank, 0.25, 1, 500, seeds)[Verdict::overconfident], nearly_all) << r;
      EXPECT_GE(verdicts(bank, 4, 1, 500, seeds)[Verdict::underconfident], nearly_all) << r;
    }
    if (r > 1e-6) {
      EXPECT_GE(verdicts(bank, 1, 0.25, 500, seeds)[Verdict::overconfident], nearly_all) << r;
      EXPECT_GE(verdicts(bank, 1, 4, 500, seeds)[Verdict::underconfident], nearly_all) << r;
    }
  }
  // No measurement noise: thirty samples are enough for a factor of four.
  const Bank exact = test::single_mode(example_bank(1, 1, 1, 1e-8), 0);
  EXPECT_GE(verdicts(exact, 0.25, 1, 30, seeds)[Verdict::overconfident], nearly_all);
  EXPECT_GE(verdicts(exact, 4, 1, 30, seeds)[Verdict::underconfident], nearly_all);
}

/// A scale learned on the way is not known exactly: the mean NIS of a true filter then lies above n_y, which many
/// samples would call significant.
TEST(Diagnostics, AdaptiveNoiseIsJudgedByTailsAlone) {
  Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-8), 0);
  bank.noise_adaptation = {0.95, 5.0};
  for (const double factor : {1.0, 0.25})  // the scale makes up for it
    EXPECT_EQ(verdicts(bank, factor, 1, 20000, 2, FilterNoise::adaptive)[Verdict::calibrated], 2) << factor;
  const Bank noisy = test::single_mode(example_bank(1, 1, 1, 1.3e-3), 0);  // but not for measurement noise
  EXPECT_EQ(verdicts(noisy, 1, 4, 1500, 10, FilterNoise::adaptive)[Verdict::underconfident], 10);
}

/// Many samples make a deviation significant that nobody would notice.
TEST(Diagnostics, AFewPercentOfVarianceAreNoVerdict) {
  const Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-8), 0);
  for (const double factor : {0.95, 1.05})
    EXPECT_EQ(verdicts(bank, factor, 1, 50000, 1)[Verdict::calibrated], 1) << factor;
}

/// Innovations of the right size that follow each other closely: hits come in groups, and a group is not many samples.
TEST(Diagnostics, GroupsOfHitsAreFewSamples) {
  Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-12), 0);
  bank.modes[0].model.A(0, 0) = -1.0;
  bank.modes[0].model.B.setZero();
  int wrong = 0;
  for (int seed = 0; seed < 60; ++seed) {
    Trajectory run = simulate_truth(bank, 400, 8000 + static_cast<std::uint64_t>(seed)).run;
    run.role = Role::test;
    for (Index k = 1; k < 400; ++k)
      run.state(0, k) = 0.95 * run.state(0, k - 1) + std::sqrt(1 - 0.95 * 0.95) * run.state(0, k);
    const Verdict verdict = diagnose("bank", bank, {}, {run}, {evaluate_run(bank, run, {})}).front().verdict;
    wrong += verdict == Verdict::overconfident || verdict == Verdict::underconfident;
  }
  EXPECT_LE(wrong, 6);
}

TEST(Diagnostics, FlagsAStateCovarianceThatIsWrong) {
  const Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-3), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 1500);
  for (const double factor : {1.0 / 16, 16.0}) {
    Bank wrong = bank;
    wrong.modes[0].Q *= factor;
    EXPECT_THAT(diagnose_runs(wrong, runs).front().flags,
                testing::HasSubstr(factor < 1 ? "NEES above a true filter's" : "NEES below a true filter's"));
  }
}

TEST(Diagnostics, NoNeesWhereTheStateIsTheMeasurement) {
  Bank bank = test::single_mode(example_bank(1, 1, 1, 1e-6), 0);
  const std::vector<Trajectory> runs = truth_runs(bank, 2, 800);
  EXPECT_TRUE(std::isfinite(diagnose_runs(bank, runs).front().nees_mean));
  bank.R *= 1e-6;
  const DiagnosticsRow row = diagnose_runs(bank, runs).front();
  EXPECT_TRUE(std::isnan(row.nees_mean) && std::isnan(row.nees_upper));
  EXPECT_NEAR(row.state_rmse(0), 1e-3, 1e-4);
  EXPECT_THAT(row.flags, testing::HasSubstr("no NEES"));
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
    EXPECT_EQ(rows[i].verdict, Verdict::calibrated) << "mode " << rows[i].mode;
    EXPECT_TRUE(inside(0.025, rows[i].tail_above_lower, rows[i].tail_above_upper)) << "mode " << rows[i].mode;
    if (i == 0) continue;
    usage += rows[i].usage;
    samples += rows[i].samples;
    EXPECT_NEAR(rows[i].usage, 1.0 / 3.0, 0.1);
    EXPECT_NEAR(rows[i].dwell_model, 20.0, 1e-9);
    EXPECT_GT(rows[i].dwell, 15.0);  // the best sequence passes over the shortest stays
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
  // One mode's runs through a bank of two that are easily told apart.
  Bank distinct = bank;
  distinct.modes[1].model.c(0) = 1.0;
  const std::string one = flags(distinct, truth_runs(test::single_mode(bank, 0), 1, 600));
  EXPECT_THAT(one, testing::AllOf(testing::HasSubstr("one mode takes all (0)"), testing::HasSubstr("mode 1 unused"),
                                  testing::Not(testing::HasSubstr("flat"))));
  // Modes that say the same.
  Bank twins = bank;
  twins.modes[1] = twins.modes[0];
  EXPECT_THAT(flags(twins, truth_runs(test::single_mode(bank, 0), 1, 600)), testing::HasSubstr("probabilities flat"));
  // Modes without noise of their own that differ in c, on a run that is in neither for long.
  Bank apart = bank;
  for (Mode& mode : apart.modes) mode.Q.setConstant(1e-6);
  apart.modes[0].model.c(0) = 1.0;
  apart.modes[1].model.c(0) = -1.0;
  apart.transition = TransitionMatrix::sticky(2, 0.5);
  EXPECT_THAT(flags(apart, truth_runs(apart, 1, 300)), testing::HasSubstr("spread dominates S"));
  // A model that is wrong about the motion.
  Bank wrong = test::single_mode(bank, 0);
  wrong.modes[0].model.A *= 0.1;
  wrong.modes[0].Q *= 4.0;
  EXPECT_THAT(flags(wrong, truth_runs(test::single_mode(bank, 0), 1, 1500)), testing::HasSubstr("not white"));
}

Interval mean_interval(const SeriesByRun& series) {
  return chi_square_mean_interval(series, autocorrelation_time(series), 1.0);
}

TEST(Diagnostics, IntervalsAreTheBooks) {
  // Clopper & Pearson (1934), table for 95 %: 3 of 10; 0 of 10; 10 of 10.
  EXPECT_NEAR(binomial_interval(3, 10).lower, 0.0667, 5e-5);
  EXPECT_NEAR(binomial_interval(3, 10).upper, 0.6525, 5e-5);
  EXPECT_EQ(binomial_interval(0, 10).lower, 0.0);
  EXPECT_NEAR(binomial_interval(0, 10).upper, 0.3085, 5e-5);
  EXPECT_NEAR(binomial_interval(10, 10).lower, 0.6915, 5e-5);
  EXPECT_TRUE(std::isnan(binomial_interval(0, 0).lower));
  // White: chi-square's own quantiles, 74.22 and 129.56 at 100 degrees of freedom.
  const Interval white = chi_square_mean_interval({std::vector<double>(100, 1.0)}, 1.0, 1.0);
  EXPECT_NEAR(white.lower, 0.7422, 5e-5);
  EXPECT_NEAR(white.upper, 1.2956, 5e-5);
  // Every value twice: as wide as for half as many.
  std::mt19937_64 generator(1);
  std::vector<double> once, twice;
  for (int i = 0; i < 4000; ++i) {
    once.push_back(static_cast<double>(generator() >> 11));
    twice.insert(twice.end(), {once.back(), once.back()});
  }
  const Interval a = mean_interval({once}), b = mean_interval({twice});
  EXPECT_NEAR((b.upper - b.lower) / (a.upper - a.lower), 1.0, 0.1);
}

}  // namespace
}  // namespace modebank
