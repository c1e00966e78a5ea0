// Texts on modes agree with the modes' numbers.
#include "app/text/mode_words.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "app/text/mode_tables.hpp"
#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using app::decay_words;
using testing::HasSubstr;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

TEST(ModeWords, DecaysAreTold) {
  EXPECT_EQ(decay_words({0.4, 0.16275, 0.0, 0.0005}), "0.16275 +- 0.00050 s");
  EXPECT_EQ(decay_words({0.4, 0.16275, 0.0, 0.0005}, "±"), "0.16275 ± 0.00050 s");
  EXPECT_EQ(decay_words({0.4, 0.16275, 0.0, unknown}), "0.1628 s");
  EXPECT_EQ(decay_words({0.9, 2.0, 1.5, unknown}), "2 s, period 0.667 s");
  EXPECT_EQ(decay_words({1.0, std::numeric_limits<double>::infinity(), 0.0, unknown}), "integrates");
  EXPECT_EQ(decay_words({1.1, -3.0, 0.0, 0.1}), "unstable, held by the loop");
  EXPECT_EQ(decay_words({0.0, 0.0, 0.0, unknown}), "at once");
  // Rates are 0.5 +- 0.5 and -0.5 +- 1 per second. The upper ends of their intervals are 1.48 and 1.46 per second.
  EXPECT_EQ(decay_words({0.95, 2.0, 0.0, 2.0}), "over 0.68 s");
  EXPECT_EQ(decay_words({1.05, -2.0, 0.0, 4.0}), "over 0.68 s");
}

/// A scalar AR(1) with factor 0.6 per sample of 0.1 s and a held input. tau = -0.1 / log 0.6 s, gain = -B / A.
TEST(ModeWords, AScalarModeInClosedForm) {
  Archive archive = screen_archive(1, 1, 1);
  archive.bank->structure.intercept = false;
  Mode& mode = archive.bank->modes[0];
  mode.model.A << -0.4;
  mode.model.B << 0.32;
  mode.standard_error = Eigen::Vector2d(0.02, 0.0);
  mode.parameter_covariance.resize(0, 0);
  const double error = 0.02 * 0.1 / (0.6 * std::log(0.6) * std::log(0.6));
  EXPECT_NEAR(error, 0.012774, 1e-6);
  const std::string text = app::modes_in_words(archive);
  EXPECT_THAT(text, HasSubstr("0.600"));
  EXPECT_THAT(text, HasSubstr("0.196 +- 0.013 s"));  // -0.1 / log 0.6 = 0.19576
  EXPECT_THAT(text, HasSubstr("0.800 +- 0.040"));    // 0.02 * 0.32 / 0.16
  EXPECT_THAT(text, HasSubstr("wz per vel0"));
}

TEST(ModeWords, ModesComeByUse) {
  Archive archive = screen_archive(1, 1, 3);
  archive.diagnostics[1].usage = 0.1;  // mode 0
  std::vector<app::UsedMode> modes = app::used_modes(archive);
  EXPECT_EQ(modes[0].mode, 1);
  EXPECT_EQ(modes[2].mode, 0);
  EXPECT_NEAR(modes[0].stay_s, 1.2, 1e-12);
  archive.diagnostics.clear();  // without scores, the stay comes from T: 1 / (1 - 0.9) samples
  modes = app::used_modes(archive);
  EXPECT_NEAR(modes[0].stay_s, 1.0, 1e-12);
  EXPECT_EQ(modes[0].mode, 0);
}

TEST(ModeWords, GainsHaveOneUnitOrEachItsOwn) {
  const Bank bank = example_bank(2, 1, 1);
  const app::GainNames shared = app::gain_names(bank, {{"a", "m"}, {"b", "m"}}, {{"u", "V"}});
  EXPECT_EQ(shared.names, (std::vector<std::string>{"a per u", "b per u"}));
  EXPECT_EQ(shared.unit, "m/V");
  const app::GainNames own = app::gain_names(bank, {{"a", "m"}, {"b", "K"}}, {{"u", "V"}});
  EXPECT_EQ(own.names, (std::vector<std::string>{"a per u [m/V]", "b per u [K/V]"}));
  EXPECT_EQ(own.unit, "");
  EXPECT_EQ(app::gain_names(bank, {{"a", ""}, {"b", ""}}, {{"u", "V"}}).unit, "");
}

}  // namespace
}  // namespace modebank::test
