// Statistics over many seeds. Tested are: standard errors are right; with the true parameters, mean NEES and NIS lie in
// their intervals; with wrong parameters, they lie outside; with learned parameters, they lie inside if the parameters
// are known well enough.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

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
  double squares = 0.0, count = 0.0, beyond = 0.0, as_known = 0.0, as_true = 0.0, nees = 0.0;
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
    const test::NeesInterval interval = test::learned_nees_interval(bank, system.truth, recording, seed, row);
    nees += row.nees_mean / static_cast<double>(seeds);
    as_known += row.nees_mean > interval.lower && row.nees_mean < interval.upper ? 1.0 : 0.0;
    as_true += row.nees_mean > row.nees_lower && row.nees_mean < row.nees_upper ? 1.0 : 0.0;
  }
  RecordProperty("rms_z", std::to_string(std::sqrt(squares / count)));
  RecordProperty("nees", std::to_string(nees));
  RecordProperty("in_a_learned_filters_interval", std::to_string(as_known));
  RecordProperty("in_a_true_filters_interval", std::to_string(as_true));
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.15);
  EXPECT_LT(beyond / count, 0.02);  // 0.27 % for a normal distribution; variances have a skewed distribution

  // 95 % of 20 is 19; fewer than 17 have a probability of 1.6 %. The interval for a correct model contains fewer (11 to
  // 18), because so few training samples give parameters with errors.
  EXPECT_GE(as_known, 17.0);
  const auto states = static_cast<double>(system.truth.structure.states);
  EXPECT_NEAR(nees, states, 0.04 * states);
}

/// Number of seeds (out of 100) for which the filter's mean NEES, its mean NIS, and both lie in their intervals.
struct Inside {
  double nees = 0.0, nis = 0.0, both = 0.0;
};

Inside count_inside(const Bank& filter, const Bank& truth, std::uint64_t seeds) {
  std::vector<DiagnosticsRow> rows(seeds);
  tbb::parallel_for(std::uint64_t{0}, seeds,
                    [&](std::uint64_t seed) { rows[seed] = test::held_out_diagnostics(filter, truth, seed); });
  Inside inside;
  for (const DiagnosticsRow& row : rows) {
    const bool nees = row.nees_mean > row.nees_lower && row.nees_mean < row.nees_upper;
    const bool nis = row.nis_mean > row.nis_lower && row.nis_mean < row.nis_upper;
    inside.nees += nees ? 1.0 : 0.0;
    inside.nis += nis ? 1.0 : 0.0;
    inside.both += nees && nis ? 1.0 : 0.0;
  }
  return inside;
}

/// 95 of 100 are expected. Fewer than 89 have a probability of 1 %, more than 99 a probability of 0.6 %. The IMM's
/// approximation has no visible effect.
TEST_P(RefineRecoverySeeds, TrueFiltersLieInTheirIntervals) {
  const Inside inside = count_inside(GetParam().truth, GetParam().truth, 100);
  EXPECT_GE(inside.nees, 89.0);
  EXPECT_LE(inside.nees, 99.0);
  EXPECT_GE(inside.nis, 89.0);
  EXPECT_LE(inside.nis, 99.0);
}

/// A factor of four on Q or R must move NEES or NIS outside its interval. One of the two may stay inside. If Q is far
/// larger than R, the state equals the measurement for any Q. If switches are rare and distant, the NIS scatters.
TEST_P(RefineRecoverySeeds, WrongFiltersDoNot) {
  for (const double factor : {0.25, 4.0})
    for (const bool process : {true, false}) {
      Bank wrong = GetParam().truth;
      if (!process) wrong.R *= factor;
      for (Mode& mode : wrong.modes)
        if (process) mode.Q *= factor;
      EXPECT_EQ(count_inside(wrong, GetParam().truth, 20).both, 0.0) << (process ? "Q x " : "R x ") << factor;
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
