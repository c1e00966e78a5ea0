// How the settings of a drifting model are chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "filter/judge/horizon.hpp"
#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/step/noise_density.hpp"
#include "modebank/base/error.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_drifting;
using test::simulate_drifting;

Recording drifting_recording(const Bank& model, Index runs, Index samples) {
  Recording recording = test::empty_recording(model.structure.states, model.structure.inputs);
  for (Index i = 0; i < runs; ++i) {
    const Trajectory run = simulate_drifting(model, samples, 50 + static_cast<std::uint64_t>(i));
    test::add_run(recording, run.state, run.input);
  }
  return recording;
}

Bank learned(const Recording& recording, const LinearStructure& structure, const DriftingGrid& grid = {}) {
  return learn_drifting(recording, fit_global(recording, structure), structure, {1, 2, 5}, grid);
}

/// Mean log density of the scored training samples.
double mean_training_score(const Bank& model, const Recording& recording) {
  double sum = 0.0, samples = 0.0;
  for (const Trajectory& run : recording.runs) {
    const Eigen::ArrayXd densities = evaluate_run(model, run, {}).log_density.array();
    if (run.role != Role::train) continue;
    sum += densities.isNaN().select(0.0, densities).sum();
    samples += static_cast<double>((!densities.isNaN()).count());
  }
  return sum / samples;
}

TEST(DriftingLearning, TheGridScoresWhatTheFilterScores) {
  Bank model = example_drifting(2, 1, 2);
  Recording recording = drifting_recording(model, 2, 90);
  recording.runs[0].state.col(20).setConstant(std::nan(""));
  recording.runs[0].state(1, 30) = std::nan("");
  recording.runs[1].time_s.tail(40).array() += 0.3;
  recording.runs[1].time_s.tail(10).array() += 100.0;
  recording.runs[1].state.col(50) *= 1e6;  // so large that the product of eight such values would overflow
  const GlobalModel global = fit_global(recording, model.structure);
  model = learn_drifting(recording, global, model.structure, {});
  const DriftingGrid grid;
  const DriftingScores scores = score_drifting_grid(model, recording, grid);
  EXPECT_TRUE(scores.log_score.allFinite());
  EXPECT_EQ(scores.log_score.size(), 6 * 5 * 3 * 8 * 5 * 4);
  EXPECT_EQ(scores.log_score(scores.best()), model.drift.tuning.log_score);
  EXPECT_EQ(scores.log_score.maxCoeff(), model.drift.tuning.log_score);
  EXPECT_NEAR(mean_training_score(model, recording), model.drift.tuning.log_score, 1e-10);
  for (Index i = 0; i < scores.log_score.size(); i += i < 700 ? 131 : 977) {
    const std::array<double, 6> at = grid.point(i);
    Bank candidate = model;
    candidate.drift.rates = {at[0], at[1], at[2]};
    candidate.running_noise.lam = at[3];
    candidate.running_noise.nu = at[4];
    candidate.running_noise.floor = at[5] * model.noise_variance();
    const double expected = mean_training_score(candidate, recording);
    EXPECT_NEAR(scores.log_score(i), expected, 1e-10 * std::max(1.0, std::abs(expected))) << i;
  }
}

TEST(DriftingLearning, NoOtherFactorMakesAHorizonMoreLikelyAndHeldOutRunsDoNotMatter) {
  const Bank truth = example_drifting(2, 1, 2);
  Recording recording = drifting_recording(truth, 2, 300);
  const Bank model = learned(recording, truth.structure);
  const auto score = [&](const Bank& of) {
    double sum = 0.0;
    for (const std::size_t i : {0u, 1u}) {
      const Eigen::ArrayXXd densities = evaluate_horizons(of, recording.runs[i], {}, {1, 2, 5}).log_density;
      sum += densities.isNaN().select(0.0, densities).sum();
    }
    return sum;
  };
  for (const std::size_t h : {0u, 1u})  // of 2 and 5: at 1 it is the filter's own
    for (const double change : {std::exp2(-0.25), std::exp2(0.25), 0.25, 4.0}) {
      Bank other = model;
      other.running_noise.horizon_factor.at(h).second *= change;
      EXPECT_GT(score(model), score(other)) << h << ", " << change;
    }
  test::add_run(recording, 9.0 * recording.runs[0].state, recording.runs[0].input, Role::test);
  EXPECT_EQ(score(learned(recording, truth.structure)), score(model));
}

/// x[k+1] = x[k] / 2 + u[k] + e, where the standard deviation of e switches between 0.05 and 1. The variance of the
/// last samples follows such noise too late.
TEST(DriftingLearning, TakesTheNoiseLevelsOfOneMotionWhereTheyGain) {
  const LinearStructure structure{1, 1, false, 1, 1, 1};
  Bank one_motion = one_mode_bank(structure, Eigen::Vector2d(-0.5, 1.0), Eigen::VectorXd::Constant(1, 0.0025));
  one_motion.modes.push_back(one_motion.modes.front());
  one_motion.modes[1].Q(0, 0) = 1.0;
  one_motion.transition = TransitionMatrix::sticky(2, 0.8);
  std::mt19937_64 generator(5);
  boost::random::uniform_01<double> uniform;
  bool loud = false;
  Recording recording = test::simulated_runs(3, 400, 5, [&](const auto& x, const auto& u, Index k, double w) {
    loud = loud != (uniform(generator) < 0.2);
    return 0.5 * x(k) + u(k) + (loud ? 1.0 : 0.05) * w;
  });
  recording.runs.back().role = Role::test;
  const Bank plain = learned(recording, structure), model = with_noise_levels(plain, one_motion, recording, {1, 2});
  ASSERT_EQ(model.running_noise.levels(), 2);
  EXPECT_NEAR(model.running_noise.level(0, 1) / model.running_noise.level(0, 0), 400.0, 1e-9);
  EXPECT_NEAR(model.drift.tuning.log_score, mean_training_score(model, recording), 1e-12);
  EXPECT_GT(log_likelihood(model, recording.runs[2], {}) - log_likelihood(plain, recording.runs[2], {}), 0.1 * 399.0);
  one_motion.modes.pop_back();
  one_motion.transition = TransitionMatrix();
  EXPECT_EQ(with_noise_levels(plain, one_motion, recording, {1, 2}).running_noise.levels(), 1);
}

/// A walk is added to x[k+1] = x[k] / 2 + u[k] + e.
TEST(DriftingLearning, TheConstantIsFreeWhereTheLevelWanders) {
  Recording recording = test::simulated_runs(
      3, 400, 2, [](const auto& x, const auto& u, Index k, double w) { return 0.5 * x(k) + u(k) + 0.05 * w; });
  std::mt19937_64 generator(2);
  boost::random::normal_distribution<double> normal;
  for (Trajectory& run : recording.runs) {
    double level = 0.0;
    for (double& value : run.state.reshaped()) value += level += 0.05 * normal(generator);
  }
  recording.runs.back().role = Role::test;
  const Tell silent = [](Level, const std::string&) {};
  const StageData data{recording, recording, nullptr, silent};
  Learning of_windows;
  of_windows.windows = test::windows_of(recording, 20, 20);
  BankInputs inputs;
  inputs.horizon = {1};
  const Bank without = learn_drifting(data, of_windows, inputs);
  inputs.lags.armax = ArmaxStructure{{true, 1, 1, 1}, {1}};
  const Bank model = learn_drifting(data, of_windows, inputs);
  EXPECT_TRUE(model.structure.intercept && !without.structure.intercept);
  const Trajectory& left_out = recording.runs[2];
  EXPECT_GT(log_likelihood(model, left_out, {}) - log_likelihood(without, left_out, {}), 0.02 * 399.0);
}

TEST(DriftingLearning, ConstantAndExactDataHaveAModel) {
  for (const double amplitude : {0.0, 1.0}) {
    Recording recording = test::simulated_runs(
        1, 60, 1, [&](const auto& x, const auto& u, Index k, double) { return 0.5 * x(k) + amplitude * u(k); });
    recording.runs[0].input *= amplitude;
    const Bank model = learned(recording, test::structure_of(recording));
    EXPECT_NO_THROW(validate(model));
    EXPECT_TRUE(std::isfinite(model.drift.tuning.log_score));
  }
}

TEST(DriftingLearning, RefusesWhatCannotBeScored) {
  const Bank truth = example_drifting(1, 1, 1);
  Recording recording = drifting_recording(truth, 1, 50);
  const GlobalModel global = fit_global(recording, truth.structure);
  DriftingGrid empty;
  empty.nu.clear();
  EXPECT_THROW(learn_drifting(recording, global, truth.structure, {}, empty), std::invalid_argument);
  recording.runs[0].role = Role::test;
  EXPECT_THROW(learn_drifting(recording, global, truth.structure, {}), DataError);
}

}  // namespace
}  // namespace modebank
