// Statistics over many seeds. Tested are: standard errors are right; with true and with learned parameters, mean NEES
// and NIS are those of a correct model; with wrong parameters, they are not.
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

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
  const auto& [name, truth, runs, samples] = GetParam();
  double squares = 0.0, count = 0.0, beyond = 0.0, nees = 0.0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Refinement refined = test::refine_blurred(truth, test::simulated_recording(truth, runs, samples, seed), 1);
    ASSERT_EQ(refined.bank.mode_count(), truth.mode_count()) << "seed " << seed;
    EXPECT_EQ(refined.measurement.end, MeasuredFit::converged) << "seed " << seed;
    for (const double z : test::z_values(refined.bank, truth)) {
      squares += z * z;
      beyond += std::abs(z) > 3.0 ? 1.0 : 0.0;
      ++count;
      EXPECT_LT(std::abs(z), 4.5) << "seed " << seed;
    }
    nees += test::held_out_diagnostics(refined.bank, truth, seed).nees_mean / static_cast<double>(seeds);
  }
  EXPECT_NEAR(std::sqrt(squares / count), 1.0, 0.15);
  EXPECT_LT(beyond / count, 0.02);  // 0.27 % for a normal distribution; variances have a skewed distribution
  const auto states = static_cast<double>(truth.structure.states);
  EXPECT_NEAR(nees, states, 0.04 * states);
}

/// Mean NEES per state and mean NIS per signal, over the seeds.
Eigen::Vector2d mean_distances(const Bank& filter, const Bank& truth, Index seeds) {
  Eigen::Matrix2Xd distances(2, seeds);
  tbb::parallel_for(Index{0}, seeds, [&](Index seed) {
    const DiagnosticsRow row = test::held_out_diagnostics(filter, truth, static_cast<std::uint64_t>(seed));
    distances.col(seed) << row.nees_mean, row.nis_mean;
  });
  return distances.rowwise().mean() / static_cast<double>(truth.structure.states);  // as many signals
}

/// The IMM's approximation has no visible effect.
TEST_P(RefineRecoverySeeds, TrueFiltersHaveTheMeansOfACorrectModel) {
  const Eigen::Vector2d mean = mean_distances(GetParam().truth, GetParam().truth, 100);
  EXPECT_LT((mean.array() - 1.0).abs().maxCoeff(), 0.04) << mean;
}

/// A factor of four on Q or R must move NEES or NIS. One of the two may stay. If Q is far larger than R, the state
/// equals the measurement for any Q. If switches are rare and distant, the NIS scatters.
TEST_P(RefineRecoverySeeds, WrongFiltersDoNot) {
  for (const double factor : {0.25, 4.0}) {
    Bank wrong_R = GetParam().truth, wrong_Q = wrong_R;
    wrong_R.R *= factor;
    for (Mode& mode : wrong_Q.modes) mode.Q *= factor;
    for (const Bank& wrong : {wrong_R, wrong_Q})
      EXPECT_GT((mean_distances(wrong, GetParam().truth, 20).array() - 1.0).abs().maxCoeff(), 0.1) << factor;
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
