// Motions of a bank: their stays, their number in words, and their rows. Expected values are closed forms.
#include "app/text/motions.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "app/text/first_screen.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/window_text.hpp"
#include "filter/step/motions.hpp"
#include "tests/app/text/screen_archive.hpp"

namespace modebank::test {
namespace {

using app::Motion;
using app::motion_words;
using testing::HasSubstr;

/// Scalar modes that stay 12 samples. Modes of one motion share A.
Archive archive_of(const std::vector<Index>& motion, Index modes) {
  Archive archive = screen_archive(1, 1, modes);
  Bank& bank = *archive.bank;
  bank.motion = motion;
  bank.transition = TransitionMatrix::sticky(modes, 11.0 / 12.0);
  for (Index k = 0; k < modes; ++k) {
    Mode& mode = bank.modes[static_cast<std::size_t>(k)];
    mode.model = bank.modes[static_cast<std::size_t>(bank.motion_of(k))].model;
  }
  return archive;
}

std::string words(const std::vector<Index>& motion, Index modes) {
  return motion_words(*archive_of(motion, modes).bank);
}

TEST(Motions, AreCountedInWords) {
  EXPECT_EQ(words({}, 1), "1 mode");
  EXPECT_EQ(words({}, 2), "2 modes");
  EXPECT_EQ(words({0, 1}, 2), "2 modes");
  EXPECT_EQ(words({0, 0}, 2), "1 motion (2 modes: calm and rough)");
  EXPECT_EQ(words({0, 0, 1, 1}, 4), "2 motions (4 modes: each calm and rough)");
  EXPECT_EQ(words({0, 1, 0, 0, 1, 1, 0, 1}, 8), "2 motions (8 modes: each at 4 noise levels)");
  EXPECT_EQ(words({0, 0, 0, 1, 2, 2, 2}, 7), "3 motions (7 modes)");
}

/// The chain leaves modes 0 and 1 at 1/10 and 1/30 per sample. Within their motion it moves as often from 0 to 1 as
/// back, so it is in mode 1 three times as long: pi = (1, 3, ..) / 4. The rate is (1/10 + 3/30) / 4 = 1/20.
TEST(Motions, StayUntilTheyAreLeft) {
  Bank bank = *archive_of({0, 0, 1}, 3).bank;
  bank.transition =
      TransitionMatrix(Eigen::MatrixXd{{0.6, 0.3, 0.1}, {0.1, 26.0 / 30.0, 1.0 / 30.0}, {0.125, 0.125, 0.75}});
  EXPECT_NEAR(stay_in_motion(bank, 0), 20.0, 1e-9);
  EXPECT_NEAR(stay_in_motion(bank, 1), 4.0, 1e-9);
  EXPECT_EQ(counted_motions(bank), 1);
  EXPECT_EQ(motion_words(bank), "1 motion and a passage (3 modes)");
  bank.motion = {};
  EXPECT_EQ(motion_words(bank), "1 motion and 2 passages (3 modes)");
  bank.motion = {0, 0, 0};
  EXPECT_TRUE(std::isinf(stay_in_motion(bank, 0)));
}

/// Uses are 0.5, 0.3 and 0.18, and each stay is 1.2 s. Half of the switches from a mode lead to each other mode.
TEST(Motions, AreRowsByUse) {
  Archive archive = archive_of({0, 1, 0}, 3);
  archive.mode_names = {"ice", "ice", "ice"};
  archive.diagnostics[2].usage = 0.9;  // mode 1
  const std::vector<Motion> motions = app::motions_of(archive);
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[0].title(), "mode 1: ice");
  EXPECT_EQ(motions[1].title(), "ice (modes 0, 2)");
  EXPECT_EQ(motions[1].number, 0);
  EXPECT_NEAR(motions[1].use, 0.68, 1e-12);
  EXPECT_NEAR(motions[0].stay_s, 1.2, 1e-12);
  EXPECT_NEAR(motions[1].stay_s, 2.4, 1e-12);
  EXPECT_EQ(motions[1].gain(0, 0), mode_dynamics(*archive.bank, 0).gain(0, 0));
  EXPECT_THAT(app::first_screen(archive, {}, "a.h5"), HasSubstr("modes     2 motions (3 modes) on held-out runs"));
  archive.mode_names[2] = "rough";
  EXPECT_EQ(app::motions_of(archive)[1].title(), "modes 0, 2");
}

TEST(Motions, UnstableOnesAreHeldByTheLoop) {
  Archive archive = archive_of({0, 0, 1}, 3);
  for (const Index k : {0, 1}) archive.bank->modes[static_cast<std::size_t>(k)].model.A(0, 0) = 0.02;
  EXPECT_THAT(app::first_screen(archive, {}, "a.h5"), HasSubstr("unstable, held by the loop"));
  EXPECT_THAT(app::modes_in_words(archive), HasSubstr("unstable, held by the loop"));
}

TEST(SensorNoise, BiasesWindowsWhereItExceedsATenthOfQ) {
  Archive archive = archive_of({}, 2);
  Bank& bank = *archive.bank;
  bank.R = 0.11 * bank.modes[0].Q;  // of the mode that is used most
  bank.modes[1].Q *= 10.0;
  EXPECT_EQ(app::sensor_noise_words(archive), "") << "no windows";
  archive.windows.emplace();
  EXPECT_EQ(app::sensor_noise_words(archive), "the windows' parameters are biased by sensor noise; the bank's are not");
  archive.mixture.emplace();
  EXPECT_THAT(app::sensor_noise_words(archive), HasSubstr("the bank's are their means"));
  bank.R = 0.09 * bank.modes[0].Q;
  EXPECT_EQ(app::sensor_noise_words(archive), "");
}

}  // namespace
}  // namespace modebank::test
