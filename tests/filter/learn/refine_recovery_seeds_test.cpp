// Statistics over many seeds. Tested are: standard errors are right; with true and with learned parameters, mean NEES
// and NIS are those of a correct model; with wrong parameters, they are not.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "tests/filter/learn/refine_recovery.hpp"

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
  double squares = 0.0, count = 0.0, beyond = 0.0, nees = 0.0;
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
    const DiagnosticsRow row = test::held_out_diagnostics(bank, system.truth, seed);
    nees += row.nees_mean / static_cast<double>(seeds);
  }
  RecordProperty("rms_z", std::to_string(std::sqrt(squares / count)));
  RecordProperty("nees", std::to_string(nees));
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.15);
  EXPECT_LT(beyond / count, 0.02);  // 0.27 % for a normal distribution; variances have a skewed distribution
  const auto states = static_cast<double>(system.truth.structure.states);
  EXPECT_NEAR(nees, states, 0.04 * states);
}

/// Mean NEES per state and mean NIS per signal, over the seeds.
struct Distances {
  double nees = 0.0, nis = 0.0;
};

Distances mean_distances(const Bank& filter, const Bank& truth, std::uint64_t seeds) {
  std::vector<DiagnosticsRow> rows(seeds);
  tbb::parallel_for(std::uint64_t{0}, seeds,
                    [&](std::uint64_t seed) { rows[seed] = test::held_out_diagnostics(filter, truth, seed); });
  Distances mean;
  for (const DiagnosticsRow& row : rows) {
    mean.nees += row.nees_mean / static_cast<double>(seeds) / static_cast<double>(truth.structure.states);
    mean.nis += row.nis_mean / static_cast<double>(seeds) / static_cast<double>(truth.C.rows());
  }
  return mean;
}

/// The IMM's approximation has no visible effect.
TEST_P(RefineRecoverySeeds, TrueFiltersHaveTheMeansOfACorrectModel) {
  const Distances mean = mean_distances(GetParam().truth, GetParam().truth, 100);
  EXPECT_NEAR(mean.nees, 1.0, 0.04);
  EXPECT_NEAR(mean.nis, 1.0, 0.04);
}

/// A factor of four on Q or R must move NEES or NIS. One of the two may stay. If Q is far larger than R, the state
/// equals the measurement for any Q. If switches are rare and distant, the NIS scatters.
TEST_P(RefineRecoverySeeds, WrongFiltersDoNot) {
  for (const double factor : {0.25, 4.0})
    for (const bool process : {true, false}) {
      Bank wrong = GetParam().truth;
      if (!process) wrong.R *= factor;
      for (Mode& mode : wrong.modes)
        if (process) mode.Q *= factor;
      const Distances mean = mean_distances(wrong, GetParam().truth, 20);
      EXPECT_GT(std::max(std::abs(mean.nees - 1.0), std::abs(mean.nis - 1.0)), 0.1)
          << (process ? "Q x " : "R x ") << factor;
    }
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
