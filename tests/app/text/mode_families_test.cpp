// Which modes form a family, and the numbers of a family. The expected values are closed forms for scalar modes.
#include "app/text/mode_families.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using app::mode_families;
using app::ModeFamily;
using testing::ElementsAre;

/// Scalar modes with gain 0.8 at a sample period of 0.1 s. `left`: factor of the state per sample. `errors`: standard
/// errors of A.
Archive scalar_modes(const std::vector<double>& left, const std::vector<double>& errors) {
  Archive archive = screen_archive(1, 1, std::ssize(left));
  archive.bank->structure.intercept = false;
  for (std::size_t k = 0; k < left.size(); ++k) {
    Mode& mode = archive.bank->modes[k];
    mode.model.A << left[k] - 1.0;
    mode.model.B << 0.8 * (1.0 - left[k]);
    mode.standard_error = Eigen::Vector2d(errors[k], 0.0);
    mode.parameter_covariance.resize(0, 0);
  }
  return archive;
}

std::vector<std::vector<Index>> modes_of(const Archive& archive) {
  std::vector<std::vector<Index>> modes;
  for (const ModeFamily& family : mode_families(archive)) modes.push_back(family.modes);
  return modes;
}

/// The time constants are -0.1 / log 0.6 = 0.196 s and so on. Modes 0 and 2 are 2.4 standard errors apart. Mode 1 is
/// within 1.4 standard errors of both and is nearer to mode 2.
TEST(ModeFamilies, NearModesAreOneAndChainsAreNone) {
  const Archive archive = scalar_modes({0.6, 0.57, 0.545}, {0.016, 0.016, 0.016});
  const auto time = [](double left) { return -0.1 / std::log(left); };
  const auto error = [](double left) { return 0.016 * 0.1 / (left * std::log(left) * std::log(left)); };
  const auto apart = [&](double a, double b) { return std::abs(time(a) - time(b)) / std::hypot(error(a), error(b)); };
  ASSERT_GT(apart(0.6, 0.545), 2.0);
  ASSERT_LT(apart(0.57, 0.545), apart(0.6, 0.57));
  ASSERT_LT(apart(0.6, 0.57), 2.0);
  EXPECT_THAT(modes_of(archive), ElementsAre(ElementsAre(0), ElementsAre(1, 2)));
}

/// Mode 0 has a time constant of 0.2 +- 0.3 s. It is within two standard errors of both other modes.
TEST(ModeFamilies, AVagueModeStandsAlone) {
  const Archive archive = scalar_modes({0.6, 0.8, 0.3}, {0.5, 0.01, 0.01});
  EXPECT_THAT(modes_of(archive), ElementsAre(ElementsAre(0), ElementsAre(1), ElementsAre(2)));
  Archive unknown = scalar_modes({0.6, 0.6}, {0.01, NAN});
  EXPECT_EQ(mode_families(unknown).size(), 2u) << "no error, no nearness";
  Archive growing = scalar_modes({1.02, 1.02}, {0.001, 0.001});
  EXPECT_EQ(mode_families(growing).size(), 2u) << "no gain";
}

TEST(ModeFamilies, GainsTellModesApart) {
  Archive archive = scalar_modes({0.6, 0.6}, {0.01, 0.01});
  EXPECT_EQ(mode_families(archive).size(), 1u);
  archive.bank->modes[1].model.B *= 1.3;
  EXPECT_EQ(mode_families(archive).size(), 2u);
}

/// The mean is 1.5. The mean of the modes' variances is 0.25, and the variance of their values is 0.75.
TEST(ModeFamilies, ErrorsHoldThoseOfTheModesAndTheirSpread) {
  const app::PooledNumber number =
      app::pooled_number(Eigen::Vector2d(1.0, 3.0), Eigen::Vector2d(0.5, 0.5), Eigen::Vector2d(0.3, 0.1));
  EXPECT_NEAR(number.value, 1.5, 1e-12);
  EXPECT_NEAR(number.error, 1.0, 1e-12);
  const app::PooledNumber unused =
      app::pooled_number(Eigen::Vector2d(1.0, 3.0), Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d::Zero());
  EXPECT_NEAR(unused.value, 2.0, 1e-12);
  EXPECT_NEAR(unused.error, 1.0, 1e-12);
}

/// Uses are 0.5, 0.3 and 0.18, and each stay is 1.2 s. A switch leads to each other mode with equal probability. So
/// half of the switches from a mode of ice lead to ice.
TEST(ModeFamilies, ModesOfOneNameAreOneByUse) {
  Archive archive = scalar_modes({0.9, 0.3, 0.6}, {0.01, 0.01, 0.01});
  archive.mode_names = {"ice", "grip", "ice"};
  archive.diagnostics[2].usage = 0.9;  // mode 1
  const std::vector<ModeFamily> families = mode_families(archive);
  ASSERT_EQ(families.size(), 2u);
  EXPECT_EQ(families[0].title(), "mode 1: grip");
  EXPECT_EQ(families[1].title(), "ice (modes 0, 2)");
  EXPECT_NEAR(families[1].use, 0.68, 1e-12);
  EXPECT_NEAR(families[1].uses[0] + families[1].uses[1], families[1].use, 1e-12);
  EXPECT_NEAR(families[0].stay_s, 1.2, 1e-12);
  EXPECT_NEAR(families[1].stay_s, 2.4, 1e-12);
  const double slow = -0.1 / std::log(0.9), fast = -0.1 / std::log(0.6);
  EXPECT_NEAR(families[1].slowest.time_constant_s, (0.5 * slow + 0.18 * fast) / 0.68, 1e-9);
  EXPECT_NEAR(families[1].gain(0, 0), 0.8, 1e-9);
  EXPECT_THAT(app::family_of_modes(families), ElementsAre(1, 0, 1));

  archive.bank->modes[0].standard_error(0) = 0.5;  // the time constant is now 0.95 +- 4.7 s
  const ModeFamily certain = mode_families(archive)[1];
  EXPECT_THAT(certain.modes, ElementsAre(0, 2));
  EXPECT_THAT(certain.counted, ElementsAre(2));
  EXPECT_NEAR(certain.slowest.time_constant_s, fast, 1e-9);
}

}  // namespace
}  // namespace modebank::test
