// The lags that are chosen for modes on left-out runs, for systems with known structure.
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <limits>

#include "filter/learn/refine/refine.hpp"
#include "tests/filter/learn/refine_recovery.hpp"

namespace modebank::test {
namespace {

LinearStructure lags(Index state, Index input) { return {1, 1, false, state, input, 1}; }

Recording three_modes(std::uint64_t seed) { return simulated_recording(true_three(), 6, 200, seed); }

/// One motion of second order, x[k+1] = 1.5 x[k] - .7 x[k-1] + .3 u[k] + w; the variance of w alternates between two
/// values.
Recording second_order(std::uint64_t seed) {
  return simulated_runs(6, 400, seed, [](const auto& x, const auto& u, Index k, double w) {
    return k == 0 ? 0.0 : 1.5 * x(k) - 0.7 * x(k - 1) + 0.3 * u(k) + (k / 50 % 2 == 0 ? 0.01 : 0.1) * w;
  });
}

/// Modes with one lag must keep it, although one linear model of all modes would use more lags. The alternative has
/// eighteen regressors too many, which each mode must learn.
TEST(StructureScore, ModesWithOneLagLeaveTheLagsThatALinearModelWants) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const StructuresOfModes compared =
        compare_structures(three_modes(seed), {lags(1, 1), lags(2, 2), lags(10, 10)}, 2, false, 1);
    EXPECT_EQ(compared.chosen, 0u) << seed;
    EXPECT_GT(compared.scores[0], compared.scores[2]) << seed;
  }
}

/// x[k+1] = a x[k] + b u[k] + w, with other coefficients in each run. Scores of left-out runs differ so much that their
/// standard error is larger than any gain. A structure with fewer lags that gains is accepted without regard to it.
TEST(StructureScore, FewerLagsThatGainNeedNoStandardError) {
  Index run = -1;
  const Recording recording = simulated_runs(6, 300, 1, [&](const auto& x, const auto& u, Index k, double w) {
    if (k == 0) ++run;
    return (0.3 + 0.1 * static_cast<double>(run)) * x(k) + (run % 2 == 0 ? 0.5 : -0.5) * u(k) + 0.02 * w;
  });
  const StructuresOfModes compared = compare_structures(recording, {lags(1, 1), lags(8, 8)}, 1, false, 1);
  EXPECT_GT(compared.scores[0], compared.scores[1] + least_structure_gain);
  EXPECT_EQ(compared.chosen, 0u);
}

/// Modes, and one motion with switching noise, must keep the two lags that a second-order motion needs.
TEST(StructureScore, TwoLagsStayWhereMotionHasThem) {
  for (const bool one_theta : {false, true}) {
    const Recording recording = second_order(4);
    for (const std::size_t incumbent : {0u, 1u}) {
      const StructuresOfModes compared =
          compare_structures(recording, {lags(1, 1), lags(2, 1)}, incumbent, one_theta, 1);
      EXPECT_GT(compared.scores[1], compared.scores[0] + 0.3) << one_theta;
      EXPECT_EQ(compared.chosen, 1u) << one_theta << incumbent;
    }
  }
}

/// Two noise levels, in equal shares, with known coefficients. The mean log density under the acting level is -(log(2
/// pi) + 1 + log(.01) + log(.1)) / 2. A switching filter finds the level within a few samples after a change.
TEST(StructureScore, IsTheLogDensityOfRunsLeftOut) {
  const StructuresOfModes compared = compare_structures(second_order(5), {lags(2, 1)}, 0, true, 1);
  const double truth = -0.5 * (std::log(2.0 * 3.14159265358979) + 1.0 + std::log(0.01) + std::log(0.1));
  EXPECT_LT(compared.scores[0], truth + 0.02);
  EXPECT_GT(compared.scores[0], truth - 0.1);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(compare_structures(second_order(5), {lags(2, 1)}, 0, true, 1).scores, compared.scores);
}

TEST(StructureScore, KeepsTheIncumbentWhereNothingCanBeLeftOut) {
  Recording recording = three_modes(8);
  for (Trajectory& run : recording.runs) run.role = Role::test;
  const StructuresOfModes compared = compare_structures(recording, {lags(1, 1), lags(2, 2)}, 1, false, 1);
  EXPECT_EQ(compared.chosen, 1u);
  EXPECT_THAT(compared.scores, testing::Each(-std::numeric_limits<double>::infinity()));
}

}  // namespace
}  // namespace modebank::test
