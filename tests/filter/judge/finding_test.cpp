// The finding about modes of motion, from scores for which the answer is known.
#include "filter/judge/finding.hpp"

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <random>

#include "tests/filter/filter_test_support.hpp"

namespace modebank {
namespace {

using Eigen::VectorXd;

/// Scores of a filter over six held-out runs: white noise that all filters share, plus `gain`.
Densities scores_of(const std::string& filter, double gain, double own_noise = 0.01) {
  std::mt19937_64 common(7), own(std::hash<std::string>()(filter));
  boost::random::normal_distribution<double> normal;
  Densities densities{filter, {}};
  for (int r = 0; r < 6; ++r) {
    VectorXd run(200);
    for (double& value : run) value = normal(common) + gain + own_noise * normal(own);
    densities.of_runs.push_back(run);
  }
  return densities;
}

struct Case {
  Bank bank = test::example_bank(1, 2, 2);
  Role role = Role::test;
  double bank_gain = 0.3;
  std::vector<Densities> competitors{scores_of("baseline", 0.0), scores_of("noise_only", 0.1),
                                     scores_of("one_motion", 0.1), scores_of("drifting", 0.05)};
  std::vector<SummaryRow> summary;
  std::vector<HorizonRow> horizons;
  std::vector<FreeRunRow> free_runs;
  std::vector<Resolution> states{{"wz", 0.0, 0.01}};
  double step_scatter = 0.0;
  std::vector<DiagnosticsRow> diagnostics;
  ErrorPattern pattern;

  Finding judged() const {
    const Densities of_bank = scores_of("bank", bank_gain);
    return judge_modes(
        {bank, role, of_bank, competitors, summary, horizons, states, free_runs, step_scatter, diagnostics, pattern});
  }
};

TEST(Finding, EvidenceIsAGainOverEveryCompetitor) {
  Case all_beaten;
  all_beaten.competitors.push_back(scores_of("nonlinear", 0.05));
  const Finding finding = all_beaten.judged();
  EXPECT_EQ(finding.answer, Answer::evidence);
  EXPECT_EQ(finding.runs, 6);
  EXPECT_EQ(finding.gains.size(), 5U);
  EXPECT_NEAR(finding.gain, 0.2, 0.01);
  EXPECT_LT(finding.standard_error, 0.01);
  EXPECT_TRUE(finding.better_description.empty());
  for (std::size_t i = 0; i < all_beaten.competitors.size(); ++i) {
    Case one_as_good = all_beaten;
    for (VectorXd& run : one_as_good.competitors[i].of_runs) run.array() += 0.4;
    const Finding other = one_as_good.judged();
    EXPECT_EQ(other.answer, Answer::no_evidence) << i;
    EXPECT_EQ(other.best_competitor, one_as_good.competitors[i].filter);
    EXPECT_EQ(other.better_description, one_as_good.competitors[i].filter);
    EXPECT_EQ(other.description, i < 3    ? Description::one_linear_motion
                                 : i == 3 ? Description::one_drifting_motion
                                          : Description::one_nonlinear_motion);
  }
}

TEST(Finding, AGainWithinItsErrorTellsNothing) {
  Case noisy;
  noisy.bank_gain = 0.19;
  for (Densities& competitor : noisy.competitors) competitor = scores_of(competitor.filter, 0.1, 1.0);
  const Finding finding = noisy.judged();
  EXPECT_EQ(finding.answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(finding), Doubt::within_chance);
  EXPECT_LE(least_beaten(finding)->gain, least_beaten(finding)->margin);
  noisy.bank_gain = 0.12;  // a loss, but one that chance gives as well
  EXPECT_LT(noisy.judged().gain, 0.0);
  EXPECT_EQ(noisy.judged().answer, Answer::cannot_tell);
  Case few;  // two samples in each of six runs are enough, in one run they are not
  for (Densities& competitor : few.competitors)
    for (VectorXd& run : competitor.of_runs) run.tail(198).setConstant(std::nan(""));
  EXPECT_EQ(few.judged().answer, Answer::evidence);
  for (Densities& competitor : few.competitors)
    for (std::size_t r = 1; r < 6; ++r) competitor.of_runs[r].setConstant(std::nan(""));
  EXPECT_EQ(few.judged().answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(few.judged()), Doubt::few_samples);
}

/// In each of these cases the gain over `noise_only` and `one_motion` is significant.
TEST(Finding, AGainBelowWhatCountsIsNoEvidence) {
  Case small;
  small.bank_gain = 0.125;
  EXPECT_EQ(small.judged().answer, Answer::evidence);
  small.bank_gain = 0.115;
  const Finding finding = small.judged();
  ASSERT_TRUE(least_beaten(finding)->told());
  ASSERT_LT(finding.gain + least_beaten(finding)->margin, 0.02);
  EXPECT_EQ(finding.answer, Answer::no_evidence);
  small.bank_gain = 0.117;  // gains of 0.012 to 0.022 over each competitor in the six runs
  for (Densities& competitor : small.competitors) {
    competitor = scores_of(competitor.filter, 0.1, 0.0);
    for (std::size_t r = 0; r < 6; ++r) competitor.of_runs[r].array() += 0.002 * (static_cast<double>(r) - 2.5);
  }
  const Finding wide = small.judged();
  ASSERT_TRUE(least_beaten(wide)->told());
  ASSERT_GT(least_beaten(wide)->gain + least_beaten(wide)->margin, 0.02);
  EXPECT_EQ(wide.answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(wide), Doubt::small_gain);
}

/// The whole gain comes from one of six runs. The t-test may find it significant, but the rank test must not.
TEST(Finding, AGainOfOneOddRunIsNoEvidence) {
  Case odd;
  odd.bank_gain = 0.0;
  odd.competitors = {scores_of("baseline", -0.03)};
  for (int r = 0; r < 3; ++r) odd.competitors[0].of_runs[r].array() += 0.032;
  odd.competitors[0].of_runs[5].array() -= 1.0;
  const Finding finding = odd.judged();
  EXPECT_GT(finding.gains[0].gain, 0.02);
  EXPECT_GT(finding.gains[0].rank_p, 0.05);
  EXPECT_EQ(finding.answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(finding), Doubt::within_chance);
}

/// Two modes, used for 3/4 and 1/4 of the time. The first is left every 10th sample, the second every 2nd sample. The
/// stay is 1 / (.75 / 10 + .25 / 2) = 5.
TEST(Finding, ModesHaveToStayForFiveSamplesAndTheModelsMemory) {
  Case passing;
  passing.diagnostics.resize(2);
  for (Eigen::Index mode = 0; mode < 2; ++mode) {
    DiagnosticsRow& row = passing.diagnostics[mode];
    row.filter = "bank";
    row.role = Role::test;
    row.mode = mode;
    row.usage = mode == 0 ? 0.75 : 0.25;
    row.dwell_model = mode == 0 ? 10.0 : 2.0;
  }
  EXPECT_NEAR(passing.judged().stay, 5.0, 1e-12);
  EXPECT_EQ(passing.judged().stay_asked, 5.0);
  passing.diagnostics[1].dwell_model = 1.9;
  const Finding passes = passing.judged();
  EXPECT_EQ(passes.answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(passes), Doubt::short_stays);
  EXPECT_EQ(passes.description, Description::none);
  passing.diagnostics[1].dwell_model = 2.1;
  EXPECT_EQ(passing.judged().answer, Answer::evidence);
  EXPECT_EQ(passing.judged().description, Description::several_modes);
}

TEST(Finding, OfSeveralThatAreAsGoodTheSimplestDescribesTheRuns) {
  Case equal;
  equal.bank_gain = 0.1;
  equal.competitors = {scores_of("baseline", 0.1), scores_of("noise_only", 0.1001), scores_of("drifting", 0.1002)};
  EXPECT_EQ(equal.judged().better_description, "baseline");
  // The baseline loses 0.4 nats in each of six runs. In one run `drifting` gains 2.6 nats more, so the t-test does not
  // tell; the ranks do.
  equal.bank_gain = 0.38;
  equal.competitors = {scores_of("baseline", 0.0), scores_of("drifting", 0.4)};
  equal.competitors[1].of_runs[2].array() += 2.6;
  EXPECT_FALSE(paired_gain("baseline", equal.competitors[1].of_runs, equal.competitors[0].of_runs).exceeds());
  EXPECT_EQ(equal.judged().better_description, "drifting");
}

TEST(Finding, WithoutHeldOutRunsCompetitorsOrModesNothingIsClaimed) {
  Case training;
  training.role = Role::train;
  EXPECT_EQ(training.judged().answer, Answer::cannot_tell);
  Case alone;
  alone.competitors.clear();
  EXPECT_EQ(alone.judged().answer, Answer::cannot_tell);
  EXPECT_TRUE(std::isnan(alone.judged().gain));
  alone.bank = test::single_mode(alone.bank, 0);
  EXPECT_EQ(alone.judged().answer, Answer::one_mode);
}

// One motion with time steps of many lengths looks like several modes. The limit is a scatter of 10 % of the median.
TEST(Finding, StepsThatScatterAndRepeatedMeasurementsComeBeforeModes) {
  Case uneven;
  uneven.step_scatter = 0.099;
  uneven.states = {{"wz", 0.09, 0.01}};
  EXPECT_EQ(uneven.judged().answer, Answer::evidence);
  uneven.states = {{"wz", 0.11, 0.01}};
  EXPECT_EQ(uneven.judged().answer, Answer::not_comparable);
  EXPECT_EQ(uneven.judged().repeating.size(), 1U);
  uneven.step_scatter = 0.101;
  EXPECT_EQ(uneven.judged().answer, Answer::not_yet);
  EXPECT_TRUE(uneven.judged().better_description.empty());
}

// Gains over competitors that lack the same lags are weak evidence for modes. A pattern counts if it gains 0.02 nats
// and two standard errors.
TEST(Finding, APatternThatLagsWouldTakeAwayComesBeforeModes) {
  Case patterned;
  for (const ErrorPattern& small : {ErrorPattern{0.019, 0.001}, ErrorPattern{0.05, 0.026}, ErrorPattern{}}) {
    patterned.pattern = small;
    EXPECT_EQ(patterned.judged().answer, Answer::evidence) << small.gain;
  }
  patterned.pattern = {0.021, 0.01};
  EXPECT_EQ(patterned.judged().answer, Answer::not_yet);
  EXPECT_EQ(patterned.judged().description, Description::none);
  patterned.bank_gain = 0.0;
  EXPECT_EQ(patterned.judged().answer, Answer::not_yet) << "no evidence without the pattern";
  EXPECT_TRUE(patterned.judged().better_description.empty());
  patterned.role = Role::train;
  EXPECT_EQ(patterned.judged().answer, Answer::cannot_tell) << "held-out runs come first";
}

SummaryRow pooled(const char* filter, double rmse) {
  return {filter, Role::test, "*", 0, 0.0, VectorXd::Constant(1, rmse)};
}

TEST(Finding, WhatOneModelLeavesNoNoiseOfHasOneMode) {
  Case exact;
  exact.states = {{"wz", 0.0, 0.5}};
  exact.summary = {pooled("bank", 1e-12), pooled("baseline", 1e-12)};
  const Finding finding = exact.judged();
  EXPECT_TRUE(finding.without_noise);
  EXPECT_EQ(finding.answer, Answer::one_mode);
  EXPECT_TRUE(finding.better_description.empty() && finding.better_means.empty());
  exact.summary = {pooled("baseline", 1e-6)};  // recorded with six digits
  EXPECT_EQ(exact.judged().answer, Answer::evidence);
}

TEST(Finding, ACompetitorThatPredictsTheMeanBetterIsNamed) {
  Case worse;
  for (const auto& [filter, rmse] : {std::pair{"bank", 0.02}, {"baseline", 0.03}, {"noise_only", 0.019}}) {
    worse.summary.push_back(pooled(filter, rmse));
    worse.horizons.push_back({filter, Role::test, "*", 10, 100, 0.0, VectorXd::Constant(1, 2.0 * rmse * rmse)});
    FreeRunRow free_run;
    free_run.filter = filter;
    free_run.role = Role::test;
    free_run.run = "*";
    free_run.rmse = VectorXd::Constant(1, 10.0 * rmse);
    worse.free_runs.push_back(free_run);
  }
  const std::vector<BetterMean> better = worse.judged().better_means;
  ASSERT_EQ(better.size(), 3U);
  EXPECT_EQ(better[0].competitor, "noise_only");
  EXPECT_EQ(better[0].horizon, 1);
  EXPECT_EQ(better[0].rmse_bank, 0.02);
  EXPECT_EQ(better[1].horizon, 10);
  EXPECT_TRUE(better[1].state.empty());
  EXPECT_EQ(better[2].horizon, 0) << "the free run stands last";
  EXPECT_DOUBLE_EQ(better[2].rmse, 0.19);
}

}  // namespace
}  // namespace modebank
