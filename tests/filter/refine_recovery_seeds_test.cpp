// Over many seeds: standard errors are right, and learned banks are calibrated on runs they have not seen.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/filter/refine_recovery.hpp"

namespace modebank {
namespace {

struct System {
  const char* name;
  Bank truth;
  Index runs, samples;
};

class RefineRecoverySeeds : public testing::TestWithParam<System> {};

TEST_P(RefineRecoverySeeds, ErrorsAreAsLargeAsStated) {
  constexpr std::uint64_t seeds = 20;
  const System& system = GetParam();
  double squares = 0.0, count = 0.0, beyond = 0.0, calibrated = 0.0, nees = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Recording recording = test::simulated_recording(system.truth, system.runs, system.samples, seed);
    const Refinement refined = test::refine_blurred(system.truth, recording, 1);
    const Bank& bank = refined.bank;
    ASSERT_EQ(bank.mode_count(), system.truth.mode_count()) << "seed " << seed;
    EXPECT_EQ(refined.measurement.end, MeasuredFit::converged) << "seed " << seed;
    for (const double z : test::z_values(bank, system.truth)) {
      squares += z * z;
      beyond += std::abs(z) > 3.0 ? 1.0 : 0.0;
      ++count;
      EXPECT_LT(std::abs(z), 4.5) << "seed " << seed;
    }
    nees += test::held_out_diagnostics(bank, system.truth, seed).nees_mean / static_cast<double>(seeds);
    // The interval knows a true filter's scatter alone, so these runs are few beside those learned from.
    const DiagnosticsRow row = test::held_out_diagnostics(bank, system.truth, seed, 100);
    if (row.nees_mean > row.nees_lower && row.nees_mean < row.nees_upper) ++calibrated;
  }
  RecordProperty("rms_z", std::to_string(std::sqrt(squares / count)));
  RecordProperty("nees", std::to_string(nees));
  RecordProperty("calibrated", std::to_string(calibrated));
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.15);
  EXPECT_LT(beyond / count, 0.02);  // 0.27 % by the normal law; variances are skewed
  // Of 20. Where R is ten times Q, the state's covariance rests on a Q known to 15 % or so, beside which the interval,
  // a true filter's, is narrow.
  EXPECT_GE(calibrated, 12.0);
  const auto states = static_cast<double>(system.truth.structure.states);
  EXPECT_NEAR(nees, states, 0.04 * states);
}

INSTANTIATE_TEST_SUITE_P(Systems, RefineRecoverySeeds,
                         testing::Values(System{"pendulum", test::true_pendulum({1.0}, 1.0), 3, 2000},
                                         System{"pendulums", test::true_pendulum({0.2, 20.0}, 1.0), 3, 3000},
                                         System{"scalar", test::true_scalar(1.0), 6, 600},
                                         System{"scalar_noisy", test::true_scalar(10.0), 6, 1000},
                                         System{"pair", test::true_pair(1.0), 6, 600},
                                         System{"pair_noisy", test::true_pair(10.0), 6, 1000}),
                         [](const testing::TestParamInfo<System>& system) { return system.param.name; });

}  // namespace
}  // namespace modebank
