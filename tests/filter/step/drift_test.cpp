// Modes that drift: laws, closed forms, an independent reference, and continuing from a snapshot.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "filter/judge/run/drifting.hpp"
#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/free_run.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/judge/run/smoother.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/step/drift_test_support.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::drifting;
using test::exact_bank;
using test::law_digits;
using test::near;
using test::one_mode;
using test::OneMode;
using test::two_routes;
using test::with_holes;

TEST(Drift, WithoutAnyWalkItIsTheBank) {
  for (const Index n : {1, 2, 5})
    for (const Index K : {1, 3})
      for (const FilterNoise noise : {FilterNoise::gaussian, FilterNoise::adaptive}) {
        const Bank bank = exact_bank(n, K);
        const Trajectory run = with_holes(test::simulate_bank(bank, 120, 2));
        FilterOptions options{FilterVariant::imm};
        options.noise = noise;
        for (const double leak : {1.0, 0.9}) {
          const Bank still = drifting(bank, {0.0, 0.0, leak});
          const RunEvaluation a = evaluate_run(bank, run, options), b = evaluate_run(still, run, options);
          EXPECT_TRUE(near(a.prediction, b.prediction, law_digits)) << n << ", " << K;
          EXPECT_TRUE(near(a.innovation_covariance, b.innovation_covariance, law_digits));
          EXPECT_TRUE(near(a.state, b.state, law_digits));
          EXPECT_TRUE(near(a.covariance, b.covariance, law_digits));
          EXPECT_TRUE(
              near(a.log_density, b.log_density,
                   law_digits * a.log_density.array().isNaN().select(0.0, a.log_density.array().abs()).maxCoeff()));
          EXPECT_TRUE(near(a.pit, b.pit, law_digits));
          EXPECT_TRUE(near(a.mode_probability, b.mode_probability, law_digits));
        }
      }
}

TEST(Drift, WithRunningNoiseHeldItIsOneModeOneStepAhead) {
  for (const Index n : {1, 2})
    for (const Index lags : {1, 3}) {
      const OneMode one = one_mode(n, lags);
      const RunEvaluation model = evaluate_run(one.model, one.run, {});
      const RunEvaluation bank = evaluate_run(one.bank, one.run, {FilterVariant::kf});
      EXPECT_TRUE(near(model.prediction, bank.prediction, two_routes)) << n << ", " << lags;
      EXPECT_TRUE(near(model.innovation_covariance, bank.innovation_covariance, two_routes));
      EXPECT_TRUE(near(model.log_density, bank.log_density, two_routes));
      EXPECT_TRUE(near(model.pit, bank.pit, two_routes));
    }
}

TEST(Drift, WithRunningNoiseHeldItIsOneModeManyStepsAhead) {
  for (const Index n : {1, 2})
    for (const Index lags : {1, 3}) {
      const OneMode one = one_mode(n, lags);
      const HorizonEvaluation model = evaluate_horizons(one.model, one.run, {}, {1, 2, 10});
      const HorizonEvaluation bank = evaluate_horizons(one.bank, one.run, {FilterVariant::kf}, {1, 2, 10});
      for (std::size_t h = 0; h < 3; ++h) EXPECT_TRUE(near(model.error[h], bank.error[h], two_routes)) << n;
      EXPECT_TRUE(near(model.log_density, bank.log_density, two_routes)) << n << ", " << lags;
    }
}

TEST(Drift, WithRunningNoiseHeldItIsOneModeInAFreeRun) {
  const OneMode one = one_mode(2, 3);
  FreeRunOptions options;
  options.samples = 100;
  const FreeRun model = free_run(one.model, one.run, {}, options);
  const FreeRun bank = free_run(one.bank, one.run, {FilterVariant::kf}, options);
  EXPECT_TRUE(near(model.mean, bank.mean, two_routes));
  EXPECT_TRUE(near(model.deviation, bank.deviation, two_routes));
}

void expect_reference(const std::string& name) {
  using nlohmann::json;
  const json golden = test::read_golden(name);
  const auto vector = [](const json& values) {
    const auto list = values.get<std::vector<double>>();
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(list.data(), std::ssize(list)));
  };
  Bank bank;
  bank.structure = {1, 1, true, 2, 2, 1};
  bank.C = Eigen::MatrixXd::Identity(1, 2);
  bank.R.setZero(1, 1);
  bank.transition = TransitionMatrix(test::golden_rows(golden.at("T")));
  bank.initial_probability = vector(golden.at("pi"));
  bank.drift = {{golden.at("rates")[0], golden.at("rates")[1], golden.at("rates")[2]}, vector(golden.at("scale"))};
  bank.noise_adaptation = {golden.at("noise")[0], golden.at("noise")[1]};
  for (std::size_t j = 0; j < 2; ++j) {
    Eigen::VectorXd theta = vector(golden.at("theta0")[j]);
    theta(0) -= 1.0;
    Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(2, 2);
    Q(0, 0) = golden.at("Q")[j];
    const double weight = golden.contains("weights") ? golden.at("weights")[j].get<double>() : 0.5;
    bank.modes.push_back({unpack(bank.structure, theta), Q, {}, {}, weight});
  }
  Trajectory run;
  run.state = vector(golden.at("y")).transpose();
  run.input = vector(golden.at("u")).transpose();
  FilterOptions options{FilterVariant::imm};
  options.noise = FilterNoise::adaptive;
  const RunEvaluation actual = evaluate_run(bank, run, options);
  const json& expected = golden.at("expected");
  const Index scored = run.samples() - 2;
  const auto of = [&](const char* dataset) { return vector(expected.at(dataset)); };
  EXPECT_TRUE(near(actual.prediction.row(0).tail(scored).transpose(), of("prediction"), two_routes));
  EXPECT_TRUE(near(actual.innovation_covariance.row(0).tail(scored).transpose(), of("variance"), two_routes));
  EXPECT_TRUE(near(actual.log_density.tail(scored), of("log_density"), two_routes));
  const Eigen::MatrixXd probability = test::golden_rows(expected.at("mode_probability"));
  EXPECT_TRUE(near(actual.mode_probability.rightCols(scored).transpose(), probability, two_routes));
}

TEST(Drift, AgreesWithTheIndependentReference) { expect_reference("drift_modes"); }
TEST(Drift, OfOneThetaAgreesWithTheIndependentReference) { expect_reference("drift_one_theta"); }

TEST(Drift, FollowsAModeThatMovedAndLeavesTheOtherAlone) {
  Bank bank = exact_bank(1, 2);
  bank.modes[1].model.A(0, 0) = -0.9;
  bank.modes[0].Q(0, 0) = bank.modes[1].Q(0, 0) = 1e-4;
  bank.transition = TransitionMatrix::sticky(2, 0.98);
  Bank moved = bank;
  moved.modes[0].model.B *= 2.0;
  const Trajectory run = test::simulate_bank(moved, 2000, 6);
  const Bank learning = drifting(bank, {1e-4, 1e-2, 1.0});
  const double known = log_likelihood(moved, run, {}), still = log_likelihood(bank, run, {});
  const double learned = log_likelihood(learning, run, {});
  EXPECT_GT(learned, still + 0.5 * (known - still));
  BankFilter filter(learning, {});
  for (Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
  const Eigen::MatrixXd theta = filter.snapshot().drift.theta;
  EXPECT_NEAR(theta(1, 0), moved.modes[0].model.B(0, 0), 0.05);
  EXPECT_NEAR(theta(1, 1), bank.modes[1].model.B(0, 0), 0.05);
}

TEST(Drift, GoesOnFromASnapshotToTheBit) {
  const Bank bank = drifting(exact_bank(2, 3), {1e-3, 0.1, 0.95});
  FilterOptions options;
  options.noise = FilterNoise::adaptive;
  const Trajectory run = with_holes(test::simulate_bank(bank, 120, 8));
  const RunEvaluation whole = evaluate_run(bank, run, options);
  BankFilter first(bank, options), second(bank, options);
  const auto step = [&](BankFilter& filter, Index k) {
    return filter.step(run.time_s(k), run.input.col(k), run.state.col(k)).log_density;
  };
  for (Index k = 0; k < 51; ++k) step(first, k);
  second.restore(first.snapshot());
  for (Index k = 51; k < run.samples(); ++k) EXPECT_EQ(step(second, k), whole.log_density(k)) << k;
  FilterSnapshot spoilt = first.snapshot();
  spoilt.drift.P[1](0, 0) = -1.0;
  EXPECT_THROW(second.restore(spoilt), std::invalid_argument);
  spoilt.drift = {};
  EXPECT_THROW(second.restore(spoilt), std::invalid_argument);
}

TEST(Drift, MostProbableModesAreThoseOfTheBankWhereNothingWanders) {
  const Bank bank = exact_bank(2, 3);
  const Trajectory run = test::simulate_bank(bank, 200, 3);
  RunEvaluation still = evaluate_run(bank, run, {}), drift = still;
  smooth_run(bank, run, {}, still);
  smooth_run(drifting(bank, {0.0, 0.0, 1.0}), run, {}, drift);
  EXPECT_EQ(still.viterbi_mode, drift.viterbi_mode);
}

TEST(Drift, RefusesWhatItCannotFollow) {
  const Bank good = drifting(exact_bank(2, 3), {1e-3, 0.1, 0.95});
  EXPECT_NO_THROW(validate(good));
  const std::vector<std::function<void(Bank&)>> spoil = {
      [](Bank& b) { b.R(0, 0) = 1e-3; },       [](Bank& b) { b.drift.rates.q = -1.0; },
      [](Bank& b) { b.drift.rates.p0 = NAN; }, [](Bank& b) { b.drift.rates.leak = 0.0; },
      [](Bank& b) { b.drift.scale(1) = 0.0; }, [](Bank& b) { b.drift.scale.conservativeResize(2); },
      [](Bank& b) { b.C(0, 1) = 0.5; },        [](Bank& b) { b.motion_parameters.push_back({"mass", "kg"}); },
  };
  for (const auto& change : spoil) {
    Bank bad = good;
    change(bad);
    EXPECT_THROW(validate(bad), std::invalid_argument);
  }
  for (const FilterVariant variant : {FilterVariant::salvi2025})
    EXPECT_THROW(BankFilter(good, {variant}), std::invalid_argument) << name_of(variant);
}

}  // namespace
}  // namespace modebank
