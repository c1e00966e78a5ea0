// The lags that are chosen for modes on left-out runs, for systems with known structure.
#include "filter/learn/refine/structure_score.hpp"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <limits>

#include "tests/filter/learn/refine_test_support.hpp"

namespace modebank::test {
namespace {

LinearStructure lags(Index state, Index input) { return {1, 1, false, state, input, 1}; }

Recording three_modes(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  Recording recording = empty_recording(1, 1);
  simulate({}, 6, 400, 1.0, Role::train, generator, recording);
  return recording;
}

/// One motion of second order, x[k+1] = 1.5 x[k] - .7 x[k-1] + .3 u[k] + w; the variance of w alternates between two
/// values.
Recording second_order(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Recording recording = empty_recording(1, 1);
  for (Index r = 0; r < 6; ++r) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 400), u(1, 400);
    for (Index k = 0; k < 400; ++k) {
      u(k) = normal(generator);
      if (k > 0 && k + 1 < 400)
        x(k + 1) = 1.5 * x(k) - 0.7 * x(k - 1) + 0.3 * u(k) + (k / 50 % 2 == 0 ? 0.01 : 0.1) * normal(generator);
    }
    add_run(recording, x, u);
  }
  return recording;
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
/// standard error is larger than any gain.
Recording another_mode_each_run(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Recording recording = empty_recording(1, 1);
  for (Index r = 0; r < 6; ++r) {
    const double a = 0.3 + 0.1 * static_cast<double>(r), b = r % 2 == 0 ? 0.5 : -0.5;
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 300), u(1, 300);
    for (Index k = 0; k < 300; ++k) {
      u(k) = normal(generator);
      if (k + 1 < 300) x(k + 1) = a * x(k) + b * u(k) + 0.02 * normal(generator);
    }
    add_run(recording, x, u);
  }
  return recording;
}

/// A structure with fewer lags that gains is accepted without regard to the standard error. Regression test: a system
/// of two states and four modes kept the three lags and the delay of five samples of its linear model. One lag would
/// have gained 0.2 nats per sample.
TEST(StructureScore, FewerLagsThatGainNeedNoStandardError) {
  const StructuresOfModes compared =
      compare_structures(another_mode_each_run(1), {lags(1, 1), lags(8, 8)}, 1, false, 1);
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
}

TEST(StructureScore, IsTheSameForAnyNumberOfThreads) {
  const Recording recording = three_modes(7);
  const auto with = [&](int threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
    return compare_structures(recording, {lags(1, 1), lags(2, 2)}, 1, false, 1).scores;
  };
  EXPECT_EQ(with(1), with(4));
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
