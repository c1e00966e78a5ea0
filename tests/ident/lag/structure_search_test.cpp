// Search for the lags and the delay of systems with known structure.
#include "ident/lag/structure_search.hpp"

#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>
#include <limits>
#include <vector>

#include "ident/lag/lagged_rows.hpp"
#include "ident/lag/structure_scorer.hpp"
#include "ident/lag/student_density.hpp"
#include "tests/ident/ident_test_support.hpp"

namespace modebank::test {
namespace {

constexpr SearchedLags all_lags{true, true, true};

/// y[k+1] = sum_i a_i y[k-i] + sum_j b_j u[k+1-delay-j] + e, with e[k+1] = rho e[k] + noise; u is held for some
/// samples.
struct System {
  std::vector<double> a{0.8}, b{0.3};
  Index delay = 1, hold = 4;
  double rho = 0.0, noise_sd = 0.02, offset = 0.0;
  Index runs = 6, samples = 400;
};

Recording simulate(const System& system, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  std::vector<Trajectory> runs;
  for (Index r = 0; r < system.runs; ++r) {
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(1, system.samples), u(1, system.samples);
    double level = 0.0, e = 0.0;
    for (Index k = 0; k < system.samples; ++k) {
      if (k % system.hold == 0) level = normal(generator);
      u(0, k) = level;
    }
    for (Index k = 0; k + 1 < system.samples; ++k) {
      e = system.rho * e + system.noise_sd * normal(generator);
      double next = system.offset + e;
      for (Index i = 0; i < std::ssize(system.a) && i <= k; ++i) next += system.a[i] * y(0, k - i);
      for (Index j = 0; j < std::ssize(system.b); ++j)
        if (const Index at = k + 1 - system.delay - j; at >= 0) next += system.b[j] * u(0, at);
      y(0, k + 1) = next;
    }
    runs.push_back(make_run(y, u));
    runs.back().run = "run" + std::to_string(r);
  }
  return make_recording(std::move(runs));
}

FoundStructure find(const Recording& recording, const SearchedLags& searched = all_lags,
                    const FitOptions& options = {}) {
  return find_structure(recording, options, searched);
}

std::array<Index, 3> lags_of(const FoundStructure& found) {
  return {found.state_lags, found.input_lags, found.input_delay.latest()};
}

int seeds_with(const System& system, const std::array<Index, 3>& expected, int seeds) {
  int right = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const auto lags = lags_of(find(simulate(system, static_cast<std::uint64_t>(seed))));
    right += lags == expected;
  }
  return right;
}

TEST(StructureSearch, FindsOneLagWhereThereIsOne) { EXPECT_GE(seeds_with({}, {1, 1, 1}, 20), 18); }

TEST(StructureSearch, FindsTheOrderOfASecondOrderMotion) {
  System second;
  second.a = {1.5, -0.7};
  EXPECT_GE(seeds_with(second, {2, 1, 1}, 20), 18);
}

/// If the system is multiplied by 1 - rho q^-1, it is an ARX model with one more lag of state and input.
TEST(StructureSearch, FindsTheLagsThatColouredNoiseNeeds) {
  System coloured;
  coloured.rho = 0.7;
  EXPECT_GE(seeds_with(coloured, {2, 2, 1}, 20), 18);
}

/// If there are few runs, stretches of runs are left out instead.
TEST(StructureSearch, FindsTheStructureInOneRun) {
  System second;
  second.a = {1.5, -0.7};
  second.runs = 1;
  second.samples = 2000;
  EXPECT_GE(seeds_with(second, {2, 1, 1}, 10), 8);
  const FoundStructure found = find(simulate(second, 0));
  EXPECT_FALSE(found.by_runs);
  EXPECT_EQ(found.parts, 10);
}

/// An input that acts at once must gain 0.02 nats over the best delayed input. An input that is held over four samples
/// does not gain that much.
TEST(StructureSearch, TakesNoDelayOnlyWhereItPays) {
  System at_once;
  at_once.delay = 0;
  EXPECT_EQ(lags_of(find(simulate(at_once, 1))), (std::array<Index, 3>{1, 1, 0}));
  System faint = at_once;
  faint.b = {0.002};
  faint.hold = 1;
  EXPECT_GT(find(simulate(faint, 1)).input_delay.latest(), 0);
}

/// Outliers have little influence: one percent of the noise is fifty times as large.
TEST(StructureSearch, IsNotMisledByOutliers) {
  int right = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    System second;
    second.a = {1.5, -0.7};
    Recording recording = simulate(second, seed);
    std::mt19937_64 generator(seed);
    boost::random::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (Trajectory& run : recording.runs)
      for (Index k = 0; k < run.samples(); ++k)
        if (uniform(generator) < 0.005) run.state(0, k) += 1.0;
    const FoundStructure found = find(recording);
    right += found.state_lags >= 2 && found.state_lags <= 6;
  }
  EXPECT_EQ(right, 10);
}

TEST(StructureSearch, MovesAnEndWhereTheBestLiesThere) {
  System late;
  late.delay = 16;
  EXPECT_EQ(lags_of(find(simulate(late, 0))), (std::array<Index, 3>{1, 1, 16}));
}

TEST(StructureSearch, KeepsWhatIsStated) {
  System second;
  second.a = {1.5, -0.7};
  const Recording recording = simulate(second, 0);
  FitOptions options;
  options.input_lags = 3;
  options.input_delay = 1;
  EXPECT_EQ(lags_of(find(recording, {true, false, false}, options)), (std::array<Index, 3>{2, 3, 1}));
  options.state_lags = 4;
  EXPECT_EQ(find(recording, {false, true, true}, options).state_lags, 4);
}

TEST(StructureSearch, KeepsToTheSamplesThatAFreeRunStartsFrom) {
  System coloured;
  coloured.a = {0.5, 0.1, 0.1, 0.1, 0.1};
  const FoundStructure found = find(simulate(coloured, 0), {true, true, true, 3});
  EXPECT_LE(std::max(found.state_lags, found.input_delay.latest() + found.input_lags - 1), 3);
}

TEST(StructureSearch, WorksWithoutInputs) {
  System alone;
  alone.a = {1.2, -0.5};
  alone.b = {0.0};
  Recording recording = simulate(alone, 0);
  recording.inputs.clear();
  for (Trajectory& run : recording.runs) run.input.resize(0, run.samples());
  const FoundStructure found = find(recording);
  EXPECT_EQ(lags_of(found), (std::array<Index, 3>{2, 1, 1}));
}

TEST(StructureSearch, DoesNotDependOnTheScaleOfChannels) {
  System second;
  second.a = {1.5, -0.7};
  Recording recording = simulate(second, 2);
  const FoundStructure before = find(recording);
  for (Trajectory& run : recording.runs) {
    run.state *= 1e4;
    run.input *= 1e-3;
  }
  const FoundStructure after = find(recording);
  EXPECT_EQ(lags_of(before), lags_of(after));
  ASSERT_EQ(before.scores.size(), after.scores.size());
  for (std::size_t i = 0; i < before.scores.size(); ++i) {
    EXPECT_NEAR(before.scores[i].log_score - std::log(1e4), after.scores[i].log_score, 1e-6);
    EXPECT_NEAR(before.scores[i].rmse(0) * 1e4, after.scores[i].rmse(0), 1e-6 * after.scores[i].rmse(0));
  }
}

TEST(StructureSearch, IsTheSameForAnyNumberOfThreads) {
  const Recording recording = simulate({}, 5);
  const auto with = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return find(recording);
  };
  const FoundStructure one = with(1), four = with(4);
  ASSERT_EQ(one.scores.size(), four.scores.size());
  for (std::size_t i = 0; i < one.scores.size(); ++i) EXPECT_EQ(one.scores[i].log_score, four.scores[i].log_score);
}

TEST(StructureSearch, HasASmallerRangeForShortRunsAndSaysSo) {
  System brief;
  brief.runs = 40;
  brief.samples = 25;
  const FoundStructure found = find(simulate(brief, 0));
  EXPECT_LE(found.state_lags, 6);
  EXPECT_THAT(found.remark, testing::HasSubstr("searched up to"));
}

/// Empty, constant and collinear data must also give a result.
TEST(StructureSearch, SurvivesDataThatDetermineNothing) {
  System tiny;
  tiny.runs = 1;
  tiny.samples = 6;
  EXPECT_THAT(find(simulate(tiny, 0)).remark, testing::HasSubstr("no search"));
  Recording recording = simulate({}, 0);
  for (Trajectory& run : recording.runs) run.input.setConstant(0.7);
  FitOptions options;
  for (const bool intercept : {false, true}) {
    options.intercept = intercept;
    EXPECT_GE(find(recording, all_lags, options).state_lags, 1);
  }
  for (Trajectory& run : recording.runs) {
    run.input = run.input.replicate(2, 1).eval();
    run.state = (run.state.array() * 5.0).round() / 5.0;  // coarse rounding
  }
  recording.inputs.resize(2);
  EXPECT_GE(find(recording).state_lags, 1);
  for (Trajectory& run : recording.runs) run.state.setZero();
  const FoundStructure still = find(recording);
  EXPECT_EQ(still.state_lags, 1);
  for (const StructureScore& score : still.scores) EXPECT_TRUE(std::isfinite(score.log_score));
}

/// Any structure that contains a noise-free motion predicts it exactly. The smallest of these structures must be
/// chosen.
TEST(StructureSearch, TakesTheSmallestExactStructure) {
  System exact;
  exact.a = {1.5, -0.7};
  exact.noise_sd = 0.0;
  EXPECT_EQ(lags_of(find(simulate(exact, 0))), (std::array<Index, 3>{2, 1, 1}));
}

/// All structures use the same rows at the start of runs and after missing samples. These are the rows with a full
/// history for the most lags.
TEST(LaggedRows, HaveTheirFullHistory) {
  Recording recording = simulate({}, 0);
  recording.runs[0].state(0, 50) = std::numeric_limits<double>::quiet_NaN();
  const StructureRanges ranges{{1, 4}, {1, 3}, {0, 5}, 1000, 0};
  const LaggedRows rows = make_lagged_rows(recording, ranges, true);
  const Index first = 5 + 3 - 2;  // the lags of transitions 0 .. 5 reach to before the run

  // the missing sample is part of the increments of two transitions, and of the lags of three more
  const Index lost_behind_gap = 5;
  EXPECT_EQ(rows.count(), 6 * (399 - first) - lost_behind_gap);
  EXPECT_EQ(rows.X.cols(), 4 + 8 + 1);
  EXPECT_EQ(rows.folds(), 5);
  EXPECT_TRUE(rows.X.allFinite());
}

}  // namespace
}  // namespace modebank::test
