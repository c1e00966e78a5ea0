// Sentences of findings. Each must state exactly what its answer means.
#include "app/text/finding_text.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "app/text/number_text.hpp"

namespace modebank {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Finding finding_of(Answer answer) {
  Finding finding;
  finding.answer = answer;
  finding.role = Role::test;
  finding.runs = 6;
  finding.modes = 3;
  finding.modes_differ = true;
  finding.best_competitor = "one_motion";
  finding.gain = 0.1344;
  finding.standard_error = 0.0402;
  finding.gains = {{"one_motion", 700, 0.1344, 0.0402, 5.0, 0.1034, false}};
  return finding;
}

TEST(FindingText, WhatCannotBeToldSaysWhy) {
  Finding finding = finding_of(Answer::cannot_tell);
  // The gain over the best competitor is 7.6 standard errors, but the gain over another competitor may be chance. The
  // sentence must name this other competitor.
  finding.gain = 0.717;
  finding.standard_error = 0.094;
  finding.gains = {{"one_motion", 700, 0.849, 0.388, 4.0, 1.077, false},
                   {"drifting", 700, 0.717, 0.094, 4.0, 0.261, false}};
  finding.best_competitor = "drifting";
  finding.runs = 5;
  EXPECT_THAT(finding_text(finding),
              AllOf(StartsWith("Cannot tell whether the 5 held-out runs have modes of motion: the gain over "
                               "`one_motion`, +0.849 +- 0.388 nats per sample, may be chance: with 5 runs, only a gain "
                               "above 1.077 passes."),
                    HasSubstr("`drifting`: one linear model whose parameters wander): each sample is 2.0 times as "
                              "likely (+0.717 +- 0.094")));
  finding.gains.front() = {"one_motion", 700, 0.12, 0.002, 4.0, 0.006, false, 0.03};
  finding.gains.back().rank_p = 0.03;
  finding.stay = 2.34;
  finding.stay_asked = 5.0;
  EXPECT_THAT(finding_text(finding), HasSubstr("modes last 2.34 samples on average (5 or more passes)"));
  finding.modes_differ = false;
  EXPECT_THAT(finding_text(finding), HasSubstr("the standard errors of the modes' parameters are unknown"));
  finding.gains.front().margin = finding.standard_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("too few independent samples"), HasSubstr("of unknown error")));
  finding.runs = 6;
  finding.role = Role::train;
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("6 training runs"), HasSubstr("no run was held out")));
}

TEST(FindingText, OneModeAndRepeatedMeasurementsClaimNothing) {
  Finding one = finding_of(Answer::one_mode);
  one.modes = 1;
  EXPECT_THAT(finding_text(one), AllOf(HasSubstr("one mode"), Not(HasSubstr("evidence"))));
  one.repeating = {{"y", 1.0, 0.0}};
  EXPECT_THAT(finding_text(one),
              HasSubstr("Its log scores measure rounding rather than motion: 100 % of the samples of y repeat"));
  Finding repeated = finding_of(Answer::not_comparable);
  repeated.repeating = {{"v", 0.78, 0.1}};
  EXPECT_THAT(finding_text(repeated),
              AllOf(HasSubstr("78 % of the samples of v repeat the one before (at most 10 % passes)"),
                    Not(HasSubstr("evidence"))));
}

TEST(FindingText, DataWithoutNoiseEndInCoefficients) {
  Finding finding = finding_of(Answer::one_mode);
  finding.without_noise = true;
  finding.coefficients = {{"y <- y", -0.1}, {"y <- u", 0.2}};
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("predicts the 6 held-out runs up to rounding"),
                                           HasSubstr("y <- y -0.1, y <- u 0.2."), Not(HasSubstr("evidence"))));
}

TEST(FindingText, StepsThatScatterClaimNothing) {
  Finding finding = finding_of(Answer::not_yet);
  finding.step_scatter = 0.426;
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("not judged yet: time steps scatter by 43 % of their median (at most 10 % passes)"),
                    Not(HasSubstr("evidence")), Not(HasSubstr("gains"))));
}

TEST(FindingText, APatternNamesTheKeyThatLooksForLags) {
  Finding finding = finding_of(Answer::not_yet);
  finding.pattern = {0.1213, 0.0149};
  EXPECT_THAT(
      finding_text(finding),
      AllOf(HasSubstr("not judged yet: the bank's errors follow a pattern. Lags would gain +0.121 +- 0.015 nats "
                      "per sample on training runs; `--window.model auto` searches for them."),
            Not(HasSubstr("evidence")), Not(HasSubstr("scatter"))));
}

/// e^0.287 = 1.332, e^-0.035 = 0.9656, e^0.0198 = 1.02, e^5 = 148.4.
TEST(FindingText, GainsAreLikelihoodsBeforeTheyAreNats) {
  EXPECT_EQ(app::likelihood_words(0.287), "1.3 times as likely");
  EXPECT_EQ(app::likelihood_words(-0.035), "3.4 % less likely");
  EXPECT_EQ(app::likelihood_words(0.0198), "2.0 % more likely");
  EXPECT_EQ(app::likelihood_words(5.0), "148 times as likely");
  EXPECT_EQ(app::likelihood_words(50.0), "over 1000 times as likely");
  EXPECT_EQ(app::likelihood_words(-50.0), "over 99 % less likely");
  EXPECT_EQ(app::likelihood_words(0.0), "as likely");
}

TEST(FindingText, AnglesAreInDegreesToo) {
  EXPECT_EQ(app::with_degrees(0.0301, "rad/s"), "0.0301 rad/s (1.72 deg/s)");  // 0.0301 * 57.29578
  EXPECT_EQ(app::with_degrees(1.5, "rad"), "1.5 rad (85.9 deg)");
  EXPECT_EQ(app::with_degrees(0.2, "m/s"), "0.2 m/s");
  EXPECT_EQ(app::with_degrees(0.2, ""), "0.2");
}

}  // namespace
}  // namespace modebank
