// Sentences of findings. Each must state exactly what its answer means.
#include "app/text/finding_text.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "app/text/number_text.hpp"

namespace modebank {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(FindingText, WhatCannotBeToldSaysWhy) {
  Finding finding;
  finding.answer = Answer::cannot_tell;
  finding.role = Role::test;
  finding.runs = 6;
  finding.modes = finding.motions = 3;
  finding.best_competitor = "one_motion";
  finding.gains = {{"one_motion", 700, 0.12, 0.002, 4.0, 0.006, false, 0.03}};
  finding.stay = 2.34;
  finding.stay_asked = 5.0;
  EXPECT_THAT(finding_text(finding), HasSubstr("modes last 2.34 samples on average (5 or more passes)"));
  finding.motions = 2;
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("motions last 2.34"), HasSubstr("between 2 motions")));
  finding.gains.front().margin = finding.standard_error = std::nan("");
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("too few independent samples"), HasSubstr("of unknown error")));
  finding.role = Role::train;
  EXPECT_THAT(finding_text(finding), AllOf(HasSubstr("6 training runs"), HasSubstr("no run was held out")));
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
