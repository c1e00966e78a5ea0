// Sentences of findings: each states exactly what its answer means.
#include "app/text/finding_text.hpp"

#include <gmock/gmock.h>

#include <limits>

namespace modebank {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

TEST(FindingText, EvidenceNamesGainErrorAndTheOtherExplanation) {
  Finding finding = finding_of(Answer::evidence);
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("6 held-out runs show evidence for modes of motion"),
                    HasSubstr("better than one does. A single nonlinear motion would look the same."),
                    HasSubstr("The bank of 3 modes gains +0.134 +- 0.040 nats per sample over one_motion (one motion "
                              "with changing noise), its best competitor.")));
  finding.terms_asked = true;
  EXPECT_THAT(finding_text(finding), Not(HasSubstr("nonlinear"))) << "no term gained on the training runs";
}

TEST(FindingText, ModesAndABendThatBothGainAreBothNamed) {
  for (const Answer answer : {Answer::evidence, Answer::no_evidence}) {
    Finding finding = finding_of(answer);
    finding.terms_asked = true;
    finding.over_linear = "noise_only";
    finding.bank_over_linear = 0.45;
    finding.nonlinear_over_linear = 0.21;
    EXPECT_THAT(finding_text(finding), HasSubstr(" Over noise_only one nonlinear motion gains +0.210 nats per sample, "
                                                 "the bank of 3 modes +0.450."));
  }
}

TEST(FindingText, NoEvidenceNamesWhatDescribesTheRunsInstead) {
  Finding finding = finding_of(Answer::no_evidence);
  finding.better_description = "drifting";
  finding.description_loss = 0.012;
  EXPECT_THAT(
      finding_text(finding),
      AllOf(HasSubstr("no evidence for modes of motion"),
            HasSubstr("These runs may be described as well by one motion whose parameters drift (drifting), the "
                      "simplest about as good as one_motion (-0.012 nats per sample).")));
  finding.better_description = "one_motion";
  EXPECT_THAT(finding_text(finding), HasSubstr("as well by one motion with changing noise (one_motion)."));
  finding.gains.front().gain = -0.2;
  EXPECT_THAT(finding_text(finding), HasSubstr("These runs are described better by one motion with changing noise"));
  finding.modes_differ = false;
  EXPECT_THAT(finding_text(finding), HasSubstr("The modes do not differ in their parameters beyond their errors"));
  finding.errors_known = false;
  EXPECT_THAT(finding_text(finding), Not(HasSubstr("beyond their errors")));
}

TEST(FindingText, OneMotionThatDriftsIsCalledSo) {
  Finding finding = finding_of(Answer::no_evidence);
  finding.one_motion_drifts = true;
  finding.better_description = "one_motion";
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("over one_motion (one drifting motion with changing noise), its best competitor."),
                    HasSubstr("as well by one drifting motion with changing noise (one_motion).")));
}

TEST(FindingText, WhatCannotBeToldSaysWhy) {
  Finding finding = finding_of(Answer::cannot_tell);
  // 7.6 standard errors over the best competitor, but within chance against another one: the sentence names that one.
  finding.gain = 0.717;
  finding.standard_error = 0.094;
  finding.gains = {{"one_motion", 700, 0.849, 0.388, 4.0, 1.077, false},
                   {"drifting", 700, 0.717, 0.094, 4.0, 0.261, false}};
  finding.best_competitor = "drifting";
  finding.runs = 5;
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("cannot be told: the gain over one_motion, +0.849 +- 0.388 nats per sample, does not "
                              "exceed what chance makes of 5 runs (1.077)."),
                    HasSubstr("gains +0.717 +- 0.094 nats per sample over drifting")));
  finding.gains.front() = {"one_motion", 700, 0.849, 0.388, 4.0, 0.8, false, 0.16};
  finding.gains.back().rank_p = 0.03;
  EXPECT_THAT(finding_text(finding), HasSubstr("rests on few of the 5 runs: ranks as high come by chance in 16 %"));
  finding.gains.front() = {"one_motion", 700, 0.012, 0.002, 4.0, 0.006, false, 0.03};
  EXPECT_THAT(finding_text(finding), HasSubstr("+0.012 +- 0.002 nats per sample, is less than the 0.02 that counts"));
  finding.gains.front().gain = 0.12;
  finding.stay = 2.34;
  finding.stay_asked = 5.0;
  EXPECT_THAT(finding_text(finding), HasSubstr("modes stay 2.34 samples in the mean"));
  finding.modes_differ = false;
  EXPECT_THAT(finding_text(finding), HasSubstr("the standard errors of the modes' parameters are not known"));
  finding.gains.front().margin = finding.standard_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("too few independent samples"), HasSubstr("of unknown error")));
  finding.runs = 6;
  finding.role = Role::train;
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("6 training runs"), HasSubstr("nothing was held out")));
}

TEST(FindingText, OneModeAndCoarseMeasurementsClaimNothing) {
  Finding one = finding_of(Answer::one_mode);
  one.modes = 1;
  EXPECT_THAT(finding_text(one), AllOf(HasSubstr("one mode"), Not(HasSubstr("evidence"))));
  one.coarse = {{"y", 0.0, 1.0, 0.0}};
  EXPECT_THAT(finding_text(one), HasSubstr("Its log scores say little: 100 % of the samples of y repeat"));
  Finding coarse = finding_of(Answer::not_comparable);
  coarse.coarse = {{"wz", 0.2, 0.0, 0.12}, {"v", 0.0, 0.78, 0.1}};
  EXPECT_THAT(finding_text(coarse),
              AllOf(HasSubstr("wz comes in steps of 0.2, predictions are uncertain by 0.12"),
                    HasSubstr("78 % of the samples of v repeat the one before"), Not(HasSubstr("evidence"))));
}

TEST(FindingText, DataWithoutNoiseEndInCoefficients) {
  Finding finding = finding_of(Answer::one_mode);
  finding.without_noise = true;
  finding.coefficients = {{"y <- y", -0.1}, {"y <- u", 0.2}};
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("describes the 6 held-out runs without noise"),
                                           HasSubstr("y <- y -0.1, y <- u 0.2."), Not(HasSubstr("evidence"))));
}

TEST(FindingText, StepsThatScatterClaimNothing) {
  Finding finding = finding_of(Answer::not_yet);
  finding.step_scatter = 0.426;
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("not judged yet: steps scatter by 43 % of their median"),
                                           Not(HasSubstr("evidence")), Not(HasSubstr("gains"))));
}

TEST(FindingText, APatternNamesTheKeyThatLooksForLags) {
  Finding finding = finding_of(Answer::not_yet);
  finding.pattern = {0.1213, 0.0149};
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("not judged yet: the bank's errors follow a pattern. Lags would gain 0.121 +- 0.015 nats "
                              "per sample on training runs; `--window.model auto` looks for them."),
                    Not(HasSubstr("evidence")), Not(HasSubstr("scatter"))));
}

TEST(FindingText, AnErrorFromBlocksSaysSo) {
  Finding finding = finding_of(Answer::evidence);
  EXPECT_THAT(finding_text(finding), Not(HasSubstr("blocks")));
  finding.gains = {{"one_motion", 700, 0.1344, 0.0402, 11.0, 0.1034, true}};
  finding.runs = 1;
  EXPECT_THAT(finding_text(finding), HasSubstr("its best competitor (error from 12 blocks of the one run)."));
  finding.runs = 3;
  EXPECT_THAT(finding_text(finding), HasSubstr("(error from 12 blocks of the 3 runs)."));
}

TEST(FindingText, ABetterMeanIsTold) {
  Finding finding = finding_of(Answer::evidence);
  finding.better_means = {
      {"noise_only", 1, "", 0.0145, 0.0141}, {"drifting", 10, "wz", 0.0504, 0.0237}, {"baseline", 0, "", 0.7, 0.6}};
  EXPECT_THAT(finding_text(finding),
              AllOf(HasSubstr("predicts the mean better one step ahead (RMSE 0.0141, the bank 0.0145; noise_only)"),
                    HasSubstr("10 samples ahead in wz (RMSE 0.0237, the bank 0.0504; drifting)"),
                    HasSubstr(", in free run (RMSE 0.6, the bank 0.7; baseline).")));
}

}  // namespace
}  // namespace modebank
