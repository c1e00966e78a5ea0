// The finding about modes of motion, from scores for which the answer is known.
#include "filter/judge/finding.hpp"

#include <gtest/gtest.h>

#include <boost/random/normal_distribution.hpp>
#include <random>

#include "filter/step/motions.hpp"
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
  double response = 1.0;

  Finding judged() const {
    const Densities of_bank = scores_of("bank", bank_gain);
    return judge_modes({bank, role, of_bank, competitors, summary, horizons, states, free_runs, step_scatter,
                        diagnostics, pattern, response});
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
  Case few;  // twelve samples in each of six runs gain 14 nats and are enough, in one run they are not
  for (Densities& competitor : few.competitors)
    for (VectorXd& run : competitor.of_runs) run.tail(188).setConstant(std::nan(""));
  EXPECT_EQ(few.judged().answer, Answer::evidence);
  for (Densities& competitor : few.competitors)
    for (std::size_t r = 1; r < 6; ++r) competitor.of_runs[r].setConstant(std::nan(""));
  EXPECT_EQ(few.judged().answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(few.judged()), Doubt::few_samples);
}

/// A plant of 2 s, logged at three rates for 300 of its response times: each asks for ten times 0.02 nats.
TEST(Finding, TheLimitOfAGainIsThatOfTheSystemNotOfItsLogger) {
  Bank plant = one_mode_bank({1, 1, false}, Eigen::Vector2d::Zero(), VectorXd::Ones(1));
  for (const double dt_s : {0.1, 0.02, 0.01}) {
    const double decay = -std::expm1(-dt_s / 2.0);
    plant.dt_s = dt_s;
    plant.modes.front().response = step_response(plant.structure, Eigen::Vector2d(-decay, decay), {}, {1}, dt_s);
    EXPECT_NEAR(response_samples(plant), 2.0 / dt_s, 1e-9);
    EXPECT_NEAR(least_nats(600.0 / dt_s, response_samples(plant)), 0.2 * 300.0, 1e-9);
  }
  plant.modes.front().response = step_response(plant.structure, Eigen::Vector2d(0.0, 1.0), {}, {1}, 0.1);
  EXPECT_EQ(response_samples(plant), 1.0) << "an integrator";
  EXPECT_EQ(least_nats(1200.0, 1.0), 24.0);
  EXPECT_EQ(least_nats(1200.0, 200.0), 12.0);
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
  small.response = 200.0;  // 12 nats in all then count, 0.01 per sample
  EXPECT_NEAR(small.judged().gains.front().least_gain, 0.01, 1e-15);
  EXPECT_EQ(small.judged().answer, Answer::evidence);
  small.response = 1.0;
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

/// A bank with these transitions and motions. Each mode is used for the same share of the judged runs.
Case with_motions(const Eigen::MatrixXd& T, const std::vector<Eigen::Index>& motion) {
  Case result;
  result.bank = test::example_bank(1, 2, T.rows());
  result.bank.transition = TransitionMatrix(T);
  result.bank.motion = motion;
  for (Eigen::Index mode = 0; mode < T.rows(); ++mode)
    result.diagnostics.push_back({"bank", Role::test, mode, 0, 1.0 / static_cast<double>(T.rows())});
  return result;
}

/// Two modes are left every 10th sample, a passage between them after s samples: the stay is 3 / (2 / 10 + 1 / s).
TEST(Finding, MotionsHaveToStayForFiveSamplesAndTheModelsMemory) {
  const auto judged = [](double s) {
    const double left = 0.5 / s;
    return with_motions(Eigen::Matrix3d{{0.9, 0.05, 0.05}, {0.05, 0.9, 0.05}, {left, left, 1.0 - 1.0 / s}}, {})
        .judged();
  };
  EXPECT_NEAR(judged(2.5).stay, 5.0, 1e-12);
  EXPECT_EQ(judged(2.5).stay_asked, 5.0);
  EXPECT_EQ(judged(2.5).motions, 2);
  const Finding passes = judged(2.4);
  EXPECT_EQ(passes.answer, Answer::cannot_tell);
  EXPECT_EQ(doubt_of(passes), Doubt::short_stays);
  EXPECT_EQ(passes.description, Description::none);
  EXPECT_EQ(judged(2.6).answer, Answer::evidence);
  EXPECT_EQ(judged(2.6).description, Description::several_modes);
}

/// Two noises of one motion change every second sample, the motions every 50th.
TEST(Finding, StaysAndEvidenceCountMotions) {
  const Eigen::Matrix3d T{{0.5, 0.48, 0.02}, {0.48, 0.5, 0.02}, {0.01, 0.01, 0.98}};
  const Finding two = with_motions(T, {0, 0, 1}).judged();
  EXPECT_NEAR(two.stay, 50.0, 1e-9);
  EXPECT_EQ(two.motions, 2);
  EXPECT_EQ(two.answer, Answer::evidence);
  EXPECT_NEAR(with_motions(T, {}).judged().stay, 3.0 / (0.5 + 0.5 + 0.02), 1e-12);
  const Finding one = with_motions(T, {0, 0, 0}).judged();
  EXPECT_TRUE(std::isnan(one.stay)) << "never left";
  EXPECT_EQ(one.motions, 1);
  EXPECT_EQ(one.answer, Answer::one_mode);
  EXPECT_EQ(one.description, Description::one_linear_motion);
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
    worse.free_runs.push_back({filter, Role::test, "*", 0, 100, 0.0, VectorXd::Constant(1, 10.0 * rmse)});
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
