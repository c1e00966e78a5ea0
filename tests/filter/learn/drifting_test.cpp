// How the settings of a drifting model are chosen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "filter/judge/horizon.hpp"
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

Bank learn_all(const Recording& recording, const LinearStructure& structure, const DriftingGrid& grid = {}) {
  return learn_drifting(recording, fit_global(recording, structure), structure, {1, 2, 5}, grid);
}

/// Mean log density of the scored training samples.
double mean_training_score(const Bank& model, const Recording& recording) {
  double sum = 0.0, samples = 0.0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    const RunEvaluation e = evaluate_run(model, run, {});
    for (const double value : e.log_density) {
      if (std::isnan(value)) continue;
      sum += value;
      ++samples;
    }
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
    const std::array<Index, 6> at = grid.point(i);
    Bank candidate = model;
    candidate.drift.rates = {grid.q.at(at[0]), grid.p0.at(at[1]), grid.leak.at(at[2])};
    candidate.running_noise.lam = grid.lam.at(at[3]);
    candidate.running_noise.nu = grid.nu.at(at[4]);
    candidate.running_noise.floor = grid.floor.at(at[5]) * model.noise_variance();
    const double expected = mean_training_score(candidate, recording);
    EXPECT_NEAR(scores.log_score(i), expected, 1e-10 * std::max(1.0, std::abs(expected))) << i;
  }
}

/// Gain of drifting coefficients over constant ones on the training runs [nats/sample].
double gain_by_drift(const Bank& truth) {
  const Recording recording = drifting_recording(truth, 4, 600);
  DriftingGrid constant;
  constant.q = constant.p0 = {0.0};
  return learn_all(recording, truth.structure).drift.tuning.log_score -
         learn_all(recording, truth.structure, constant).drift.tuning.log_score;
}

TEST(DriftingLearning, FindsDriftWhereThereIsSomeAndNoneWhereThereIsNone) {
  Bank truth = example_drifting(1, 2, 1);
  truth.running_noise.nu = 0.0;
  truth.drift.rates = {0.03, 0.1, 0.95};
  EXPECT_GT(gain_by_drift(truth), 0.05);
  truth.drift.rates = {0.0, 0.0, 1.0};
  EXPECT_LT(gain_by_drift(truth), 2e-3) << "4 free coefficients fit 2400 samples by chance that well";
}

TEST(DriftingLearning, NoOtherFactorMakesAHorizonMoreLikely) {
  Bank truth = example_drifting(2, 1, 2);
  truth.running_noise.nu = 3.0;
  const Recording recording = drifting_recording(truth, 2, 300);
  const Bank model = learn_all(recording, truth.structure);
  ASSERT_EQ(model.running_noise.horizon_factor.size(), 2u) << "of 2 and 5: at 1 it is the filter's own";
  const auto score = [&](const Bank& candidate, Index horizon) {
    double sum = 0.0;
    for (const Trajectory& run : recording.runs) {
      const HorizonEvaluation ahead = evaluate_horizons(candidate, run, {}, {horizon});
      for (const double value : ahead.log_density.row(0)) sum += std::isnan(value) ? 0.0 : value;
    }
    return sum;
  };
  for (std::size_t h = 0; h < 2; ++h)
    for (const double change : {std::exp2(-0.25), std::exp2(0.25), 4.0, 0.25}) {
      Bank other = model;
      other.running_noise.horizon_factor[h].second *= change;
      EXPECT_GT(score(model, model.running_noise.horizon_factor[h].first),
                score(other, model.running_noise.horizon_factor[h].first));
    }
}

/// x[k+1] = x[k] / 2 + u[k] + e, where the standard deviation of e switches between 0.05 and 1. The variance of the
/// last samples follows such noise too late.
TEST(DriftingLearning, TakesTheNoiseLevelsOfOneMotionWhereTheyGain) {
  const LinearStructure structure{1, 1, false, 1, 1, 1};
  Bank one_motion = one_mode_bank(structure, Eigen::Vector2d(-0.5, 1.0), Eigen::VectorXd::Constant(1, 0.0025));
  one_motion.modes.push_back(one_motion.modes.front());
  one_motion.modes[1].Q(0, 0) = 1.0;
  one_motion.transition = TransitionMatrix::sticky(2, 0.8);
  Recording recording = test::empty_recording(1, 1);
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_01<double> uniform;
  for (Index run = 0; run < 3; ++run) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 400), u(1, 400);
    bool loud = false;
    for (Index k = 0; k < 400; ++k) {
      u(0, k) = normal(generator);
      if (uniform(generator) < 0.2) loud = !loud;
      if (k > 0) x(0, k) = 0.5 * x(0, k - 1) + u(0, k - 1) + (loud ? 1.0 : 0.05) * normal(generator);
    }
    test::add_run(recording, x, u, run < 2 ? Role::train : Role::test);
  }
  const Bank plain = learn_all(recording, structure), model = with_noise_levels(plain, one_motion, recording, {1, 2});
  ASSERT_EQ(model.running_noise.levels(), 2);
  EXPECT_NEAR(model.running_noise.level(0, 1) / model.running_noise.level(0, 0), 400.0, 1e-9);
  EXPECT_NEAR(model.drift.tuning.log_score, mean_training_score(model, recording), 1e-12);
  EXPECT_GT(log_likelihood(model, recording.runs[2], {}) - log_likelihood(plain, recording.runs[2], {}), 0.1 * 399.0);
  one_motion.modes.pop_back();
  one_motion.transition = TransitionMatrix();
  EXPECT_EQ(with_noise_levels(plain, one_motion, recording, {1, 2}).running_noise.levels(), 1);
}

TEST(DriftingLearning, HeldOutRunsDoNotMatter) {
  const Bank truth = example_drifting(1, 1, 1);
  Recording recording = drifting_recording(truth, 2, 200);
  const GlobalModel global = fit_global(recording, truth.structure);
  const auto settings = [&] {
    const Bank m = learn_drifting(recording, global, truth.structure, {3});
    return std::make_tuple(m.drift.rates.q, m.drift.rates.p0, m.running_noise.lam, m.running_noise.nu, m.drift.scale,
                           m.running_noise.horizon_factor, m.drift.tuning.log_score);
  };
  const auto before = settings();
  test::add_run(recording, 9.0 * recording.runs[0].state, recording.runs[0].input, Role::test);
  EXPECT_EQ(before, settings());
}

TEST(DriftingLearning, ConstantAndExactDataHaveAModel) {
  for (const double amplitude : {0.0, 1.0}) {
    Recording recording = test::empty_recording(1, 1);
    Eigen::MatrixXd u(1, 60), x = Eigen::MatrixXd::Zero(1, 60);
    for (Index k = 0; k < 60; ++k) u(0, k) = amplitude * std::sin(static_cast<double>(k));
    for (Index k = 1; k < 60; ++k) x(0, k) = 0.5 * x(0, k - 1) + u(0, k - 1);
    test::add_run(recording, x, u);
    const Bank model = learn_all(recording, test::structure_of(recording));
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
