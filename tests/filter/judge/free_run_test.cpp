// Predictions without measurements, to the end of a run.
#include "filter/judge/free_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/sample_paths.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using test::example_bank;
using test::near;
using test::simulate_bank;
using test::single_mode;
using ::testing::HasSubstr;

FreeRunOptions after(Index samples, FreeRunMethod method = FreeRunMethod::moments, Index paths = 400) {
  FreeRunOptions options;
  options.samples = samples;
  options.method = method;
  options.paths = paths;
  return options;
}

/// A bank of one mode that measures its states without noise.
Bank arx_bank(const LinearStructure& s, const Eigen::VectorXd& theta) {
  Bank bank;
  bank.structure = s;
  Mode mode;
  mode.model = unpack(s, theta);
  mode.Q = Eigen::MatrixXd::Zero(s.dimension(), s.dimension());
  mode.Q.topLeftCorner(s.states, s.states).setIdentity();
  bank.modes = {mode};
  bank.C = Eigen::MatrixXd::Identity(s.states, s.dimension());
  bank.R = Eigen::MatrixXd::Zero(s.states, s.states);
  bank.initial_probability = Eigen::VectorXd::Ones(1);
  return bank;
}

/// theta of a stable model: -0.4 and then little from each older sample.
Eigen::VectorXd stable_theta(const LinearStructure& s) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(s.regressors(), s.states);
  for (Index i = 0; i < s.states; ++i) {
    for (Index lag = 0; lag < s.state_lags; ++lag)
      rows(lag * s.states + i, i) = lag == 0 ? -0.4 : 0.1 / static_cast<double>(lag);
    rows.col(i).segment(s.dimension(), s.acting_inputs()).setLinSpaced(0.3, -0.2);
    if (s.states > 1) rows((i + 1) % s.states, i) = 0.05;
    if (s.intercept) rows(s.regressors() - 1, i) = 0.02;
  }
  return rows.reshaped();
}

Trajectory any_run(const LinearStructure& s, Index samples) {
  Trajectory run;
  run.run = "any";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state.resize(s.states, samples);
  run.input.resize(s.inputs, samples);
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < s.states; ++i) run.state(i, k) = std::sin(0.7 * static_cast<double>(k + i));
    for (Index i = 0; i < s.inputs; ++i)
      run.input(i, k) = std::cos(1.3 * static_cast<double>(k) + static_cast<double>(i));
  }
  return run;
}

/// x[k+1] = x[k] + sum A_i x[k+1-i] + sum B_j u[k+1-d-j] + c after n measured samples, from theta itself.
Eigen::MatrixXd arx_recursion(const LinearStructure& s, const Eigen::VectorXd& theta, const Trajectory& run, Index n) {
  Eigen::MatrixXd x = run.state;
  for (Index k = n; k < x.cols(); ++k)
    for (Index i = 0; i < s.states; ++i) {
      Index p = i * s.regressors();
      double next = x(i, k - 1);
      for (Index lag = 1; lag <= s.state_lags; ++lag)
        for (Index j = 0; j < s.states; ++j) next += theta(p++) * x(j, k - lag);
      for (Index lag = 0; lag < s.input_lags; ++lag)
        for (Index j = 0; j < s.inputs; ++j) next += theta(p++) * run.input(j, k - s.input_delay - lag);
      if (s.intercept) next += theta(p);
      x(i, k) = next;
    }
  x.leftCols(n).setConstant(std::nan(""));
  return x;
}

TEST(FreeRun, OneModeIsThePlainRecursion) {
  const LinearStructure structures[]{{1, 1, true}, {2, 2, true}, {1, 1, true, 3, 3, 0}, {2, 1, false, 2, 3, 2}};
  for (const LinearStructure& s : structures) {
    const Eigen::VectorXd theta = stable_theta(s);
    const Bank bank = arx_bank(s, theta);
    const Trajectory run = any_run(s, 120);
    const Eigen::MatrixXd expected = arx_recursion(s, theta, run, 8);
    for (const FreeRunStart start : {FreeRunStart::estimated, FreeRunStart::fixed}) {
      FreeRunOptions options = after(8);
      options.start = start;
      const FreeRun found = free_run(bank, run, {}, options);
      EXPECT_TRUE(near(found.mean, expected, 1e-12)) << s.state_lags;
      EXPECT_TRUE(found.notes.empty());
    }
    FreeRunOptions few = after(8);
    few.horizon = 10;
    const FreeRun ended = free_run(bank, run, {}, few);
    EXPECT_TRUE(near(ended.mean.middleCols(8, 10), expected.middleCols(8, 10), 1e-12));
    EXPECT_TRUE(ended.mean.rightCols(120 - 18).array().isNaN().all());
  }
}

TEST(FreeRun, DriftingCoefficientsThatDoNotDriftAreThePlainRecursion) {
  DriftingModel model = test::example_drifting(2, 1, 2);
  model.rates = {0.0, 0.0, 0.97};
  const Trajectory run = any_run(model.structure, 80);
  EXPECT_TRUE(near(free_run(model, run, TimeSteps::repeat, after(5)).mean,
                   arx_recursion(model.structure, model.theta0, run, 5), 1e-12));
}

/// Two modes of one state that differ in everything; T is not symmetric.
Bank two_modes() {
  Bank bank = example_bank(1, 1, 2, 1e-3);
  bank.modes[1].model.A(0, 0) = 0.1;
  bank.modes[1].model.c(0) = 0.3;
  bank.modes[1].Q(0, 0) = 0.01;
  bank.transition = TransitionMatrix((Eigen::Matrix2d() << 0.8, 0.2, 0.4, 0.6).finished());
  bank.initial_probability << 0.7, 0.3;
  return bank;
}

/// Every sequence of modes with its probability, and the Gaussian that x has given it, `steps` after x[0] ~ N(y, R).
struct Sequences {
  std::vector<double> probability, mean, variance;

  Sequences(const Bank& bank, const Trajectory& run, Index steps) {
    extend(bank, run, steps, 0, -1, 1.0, run.state(0, 0), bank.R(0, 0));
  }
  double average() const {
    double sum = 0.0;
    for (std::size_t s = 0; s < mean.size(); ++s) sum += probability[s] * mean[s];
    return sum;
  }
  double deviation(double R) const {
    double sum = R;
    for (std::size_t s = 0; s < mean.size(); ++s)
      sum += probability[s] * (variance[s] + (mean[s] - average()) * (mean[s] - average()));
    return std::sqrt(sum);
  }
  double below(double y, double R) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < mean.size(); ++s)
      sum += probability[s] * 0.5 * std::erfc((mean[s] - y) / std::sqrt(2.0 * (variance[s] + R)));
    return sum;
  }

 private:
  void extend(const Bank& bank, const Trajectory& run, Index steps, Index k, Index mode, double p, double m, double P) {
    if (k == steps) {
      probability.push_back(p);
      mean.push_back(m);
      variance.push_back(P);
      return;
    }
    const Eigen::RowVectorXd row =
        mode < 0 ? Eigen::RowVectorXd(bank.initial_probability.transpose() * bank.transition.matrix())
                 : Eigen::RowVectorXd(bank.transition.matrix().row(mode));
    for (Index j = 0; j < row.size(); ++j) {
      const Mode& next = bank.modes[static_cast<std::size_t>(j)];
      const double F = 1.0 + next.model.A(0, 0);
      extend(bank, run, steps, k + 1, j, p * row(j), F * m + next.model.B(0, 0) * run.input(0, k) + next.model.c(0),
             F * F * P + next.Q(0, 0));
    }
  }
};

TEST(FreeRun, MomentsAreThoseOfAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  const FreeRun found = free_run(bank, run, {}, after(1));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 1e-9) << k;
    EXPECT_NEAR(found.deviation(0, k), exact.deviation(bank.R(0, 0)), 1e-9) << k;
  }
  // After one step it is a Gaussian per mode, so that band and density are exact, too.
  const Sequences exact(bank, run, 1);
  EXPECT_NEAR(exact.below(found.lower(0, 1), bank.R(0, 0)), 0.025, 1e-9);
  EXPECT_NEAR(exact.below(found.upper(0, 1), bank.R(0, 0)), 0.975, 1e-9);
  EXPECT_NEAR(found.pit(0, 1), exact.below(run.state(0, 1), bank.R(0, 0)), 1e-9);
}

TEST(FreeRun, SamplePathsAreDrawnFromAllSequencesOfModes) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 9, 3);
  constexpr Index paths = 20000;
  const FreeRun found = free_run(bank, run, {}, after(1, FreeRunMethod::paths, paths));
  const double R = bank.R(0, 0), of_band = 5.0 * std::sqrt(0.025 / static_cast<double>(paths));
  for (Index k = 1; k < run.samples(); ++k) {
    const Sequences exact(bank, run, k);
    const double sd = exact.deviation(R);
    EXPECT_NEAR(found.mean(0, k), exact.average(), 5.0 * sd / std::sqrt(static_cast<double>(paths))) << k;
    EXPECT_NEAR(found.deviation(0, k), sd, 0.04 * sd) << k;
    EXPECT_NEAR(exact.below(found.lower(0, k), R), 0.025, of_band) << k;
    EXPECT_NEAR(exact.below(found.upper(0, k), R), 0.975, of_band) << k;
    EXPECT_NEAR(found.pit(0, k), exact.below(run.state(0, k), R), 5.0 * 0.5 / std::sqrt(static_cast<double>(paths)));
  }
  EXPECT_EQ(found.lost_paths, 0);
}

TEST(FreeRun, MomentsAndPathsAgreeWithLagsSeveralStatesAndAdaptiveNoise) {
  LinearStructure s{2, 1, true, 2, 2, 1};
  Bank bank = arx_bank(s, stable_theta(s));
  bank.modes.push_back(bank.modes[0]);
  bank.modes[1].model.B *= -1.0;
  for (Mode& mode : bank.modes) mode.Q *= 0.01;
  bank.R = 1e-3 * Eigen::Matrix2d::Identity();
  bank.transition = TransitionMatrix::sticky(2, 0.8);
  bank.initial_probability = Eigen::Vector2d::Constant(0.5);
  const Trajectory run = any_run(s, 60);
  for (const FilterNoise noise : {FilterNoise::gaussian, FilterNoise::adaptive}) {
    const FilterOptions filter{.noise = noise};
    const FreeRun exact = free_run(bank, run, filter, after(20)),
                  drawn = free_run(bank, run, filter, after(20, FreeRunMethod::paths, 10000));
    const Eigen::ArrayXXd sd = exact.deviation.rightCols(40);
    EXPECT_LT(((drawn.mean - exact.mean).rightCols(40).array() / sd).abs().maxCoeff(), 0.06);
    EXPECT_LT((drawn.deviation.rightCols(40).array() / sd - 1.0).abs().maxCoeff(), 0.05);
    EXPECT_LT((drawn.log_density - exact.log_density).tail(40).cwiseAbs().mean(), 0.1);
  }
}

TEST(FreeRun, FirstPredictionIsTheFilters) {
  const Bank bank = example_bank(2, 1, 3);
  const Trajectory run = simulate_bank(bank, 30, 4);
  const RunEvaluation filter = evaluate_run(bank, run, {});
  const FreeRun found = free_run(bank, run, {}, after(20));
  EXPECT_TRUE(near(found.mean.col(20), bank.C * filter.prediction.col(20), 1e-12));
  EXPECT_NEAR(found.log_density(20), filter.log_density(20), 1e-10);
  EXPECT_NEAR(found.pit(0, 20), filter.pit(0, 20), 1e-10);
}

TEST(FreeRun, EqualSeedsAreEqualPaths) {
  const Bank bank = two_modes();
  const Trajectory run = simulate_bank(bank, 50, 5);
  FreeRunOptions options = after(3, FreeRunMethod::paths, 30);
  const FreeRun one = free_run(bank, run, {}, options), same = free_run(bank, run, {}, options);
  EXPECT_TRUE(near(one.mean, same.mean, 0.0) && near(one.upper, same.upper, 0.0));
  options.seed = 2;
  EXPECT_FALSE(near(one.mean, free_run(bank, run, {}, options).mean, 0.0));
}

TEST(FreeRun, SaysOfPathsThatLeaveTheFiniteRange) {
  Bank bank = two_modes();
  bank.modes[1].model.A(0, 0) = 1e4;
  bank.transition = TransitionMatrix((Eigen::Matrix2d() << 0.9, 0.1, 0.01, 0.99).finished());
  const Trajectory run = simulate_bank(two_modes(), 200, 6);
  const FreeRun found = free_run(bank, run, {}, after(1, FreeRunMethod::paths, 50));
  EXPECT_EQ(found.lost_paths, 50);
  ASSERT_EQ(found.notes.size(), 1u);
  EXPECT_THAT(found.notes[0], HasSubstr("beyond it nothing is finite"));
  const Index predicted = (!found.mean.row(0).array().isNaN()).count();
  EXPECT_GT(predicted, 10);
  EXPECT_TRUE(found.mean.middleCols(1, predicted).allFinite());
}

TEST(FreeRun, StartsAnewAfterAGapAndSaysWhereItCannot) {
  Bank bank = example_bank(1, 1, 2);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 30, 7);
  run.time_s.tail(18).array() += 2.0 * static_cast<double>(longest_gap_steps);
  Trajectory tail = run;
  tail.time_s = run.time_s.tail(18).eval();
  tail.state = run.state.rightCols(18).eval();
  tail.input = run.input.rightCols(18).eval();
  const FreeRun all = free_run(bank, run, {}, after(5)), part = free_run(bank, tail, {}, after(5));
  EXPECT_TRUE(near(all.mean.rightCols(18), part.mean, 0.0));
  EXPECT_TRUE(std::isnan(all.mean(0, 16)) && !std::isnan(all.mean(0, 11)));
  const FreeRun little = free_run(bank, run, {}, after(15));
  ASSERT_EQ(little.notes.size(), 1u);
  EXPECT_EQ(little.notes[0],
            "has 12 samples from sample 0 on, of which 15 are to be measured: none is left to predict");
  EXPECT_FALSE(std::isnan(little.mean(0, 29)));
  run.state.leftCols(5).setConstant(std::nan(""));
  EXPECT_THAT(free_run(bank, run, {}, after(4)).notes.at(0), HasSubstr("too few whole measurements"));
  EXPECT_THROW(free_run(arx_bank({1, 1, false, 4, 1, 1}, stable_theta({1, 1, false, 4, 1, 1})), run, {}, after(3)),
               std::invalid_argument);
}

TEST(FreeRun, PredictsThroughGapsAndMissingSamples) {
  Bank bank = single_mode(example_bank(1, 1, 1), 0);
  bank.dt_s = 1.0;
  Trajectory run = simulate_bank(bank, 20, 8);
  run.time_s.tail(10).array() += 3.0;  // three model steps more, the input held
  run.state(0, 15) = std::nan("");
  const FreeRun found = free_run(bank, run, {}, after(4));
  double x = found.mean(0, 9);
  for (int i = 0; i < 4; ++i) x = bank.modes[0].model.next(Eigen::VectorXd::Constant(1, x), run.input.col(9))(0);
  EXPECT_NEAR(found.mean(0, 10), x, 1e-12);
  EXPECT_FALSE(std::isnan(found.mean(0, 15)));
  EXPECT_TRUE(std::isnan(found.log_density(15)) && std::isnan(found.pit(0, 15)));
}

/// A guard: mode 1 where x is positive. Without noise the path is the piecewise recursion itself.
TEST(SamplePaths, ModesMayFollowStateAndInput) {
  Bank bank = two_modes();
  for (Mode& mode : bank.modes) mode.Q.setZero();
  bank.modes[1].model.A(0, 0) = -0.8;
  bank.modes[1].model.c(0) = 0.1;
  bank.modes[0].model.c(0) = 0.1;
  const Trajectory run = simulate_bank(two_modes(), 40, 9);
  const auto guard = [](double x, double u) { return x + u > 0.5 ? 1 : 0; };
  SamplePaths paths(bank, {}, 5, 1, [&](Index, const auto& x, const auto& u, Eigen::VectorXd& row) {
    row.setZero()(guard(x(0), u(0))) = 1.0;
  });
  FilterMemory origin{Eigen::MatrixXd::Constant(1, 2, 0.4), Eigen::MatrixXd::Zero(1, 2), bank.initial_probability, 1.0,
                      0.0};
  paths.start(origin);
  double x = 0.4;
  std::array<int, 2> visits{};
  for (Index k = 0; k < run.samples(); ++k) {
    const int mode = guard(x, run.input(0, k));
    ++visits[static_cast<std::size_t>(mode)];
    x = bank.modes[static_cast<std::size_t>(mode)].model.next(Eigen::VectorXd::Constant(1, x), run.input.col(k))(0);
    paths.step(run.input.col(k));
    EXPECT_TRUE(near(paths.states(), Eigen::MatrixXd::Constant(1, 5, x), 1e-12)) << k;
    EXPECT_EQ(paths.modes(), std::vector<Index>(5, mode));
  }
  EXPECT_GT(visits[0], 3);
  EXPECT_GT(visits[1], 3);
}

TEST(FreeRunScores, HaveTheirClosedForms) {
  Trajectory a, b;
  a.run = "a";
  a.state = (Eigen::RowVectorXd(5) << 9, 1, 2, 3, 4).finished();
  b.run = "b";
  b.state = (Eigen::RowVectorXd(2) << 0, 10).finished();
  for (Trajectory* run : {&a, &b}) run->input = Eigen::MatrixXd::Zero(1, run->state.cols());
  const auto predicted = [](const Eigen::RowVectorXd& mean, const Eigen::RowVectorXd& pit) {
    FreeRun result;
    result.mean = mean;
    result.pit = pit;
    result.log_density = (mean.array() * 0.0 - 1.5).matrix().transpose();
    return result;
  };
  const double nan = std::nan("");
  const std::vector<FreeRun> runs{
      predicted((Eigen::RowVectorXd(5) << nan, 1, 2, 3, 5).finished(),
                (Eigen::RowVectorXd(5) << nan, 0.5, 0.2, 0.04, 0.999).finished()),
      predicted((Eigen::RowVectorXd(2) << nan, 8).finished(), (Eigen::RowVectorXd(2) << nan, 0.03).finished())};
  const std::vector<FreeRunRow> rows = summarize_free_runs("bank", {a, b}, runs, after(1));
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].samples, 4);
  EXPECT_EQ(rows[0].start, 1);
  EXPECT_DOUBLE_EQ(rows[0].log_score, -1.5);
  EXPECT_DOUBLE_EQ(rows[0].rmse(0), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].nrmse(0), 0.5 / std::sqrt(1.25));
  EXPECT_DOUBLE_EQ(rows[0].fit(0), 100.0 * (1.0 - 1.0 / std::sqrt(5.0)));  // ||y - yhat|| = 1, ||y - 2.5|| = sqrt 5
  EXPECT_DOUBLE_EQ(rows[0].coverage_50(0), 0.25);
  EXPECT_DOUBLE_EQ(rows[0].coverage_90(0), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].coverage_95(0), 0.75);
  EXPECT_DOUBLE_EQ(rows[0].coverage_99(0), 0.75);
  EXPECT_TRUE(std::isnan(rows[1].nrmse(0)));  // one sample has no spread
  EXPECT_EQ(rows[2].run, "*");
  EXPECT_DOUBLE_EQ(rows[2].rmse(0), 1.0);
  EXPECT_DOUBLE_EQ(rows[2].fit(0), 100.0 * (1.0 - std::sqrt(5.0 / 50.0)));  // y = 1 2 3 4 10 about 4
  EXPECT_DOUBLE_EQ(rows[2].coverage_95(0), 0.8);
}

}  // namespace
}  // namespace modebank
