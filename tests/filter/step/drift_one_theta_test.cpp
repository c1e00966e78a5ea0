// Modes that share theta and differ only in noise. What one mode learns about theta applies to all modes.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "filter/judge/run/evaluate.hpp"
#include "filter/judge/run/horizon.hpp"
#include "filter/step/bank_filter.hpp"
#include "ident/model/linear_model.hpp"
#include "tests/filter/step/drift_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::drifting;
using test::exact_bank;
using test::near;
using test::one_mode;
using test::OneMode;
using test::two_routes;
using test::with_holes;

TEST(DriftOfOneTheta, ModesThatAreTheSameAreOneThatDrifts) {
  for (const Index lags : {1, 3}) {
    const OneMode one = one_mode(2, lags);
    Bank twice = one.bank;
    twice.modes.push_back(twice.modes[0]);
    twice.transition = TransitionMatrix::sticky(2, 0.9);
    twice.initial_probability.setConstant(2, 0.5);
    const Trajectory run = with_holes(one.run);
    const RunEvaluation a = evaluate_run(one.bank, run, {FilterVariant::kf}), b = evaluate_run(twice, run, {});
    EXPECT_TRUE(near(a.prediction, b.prediction, two_routes)) << lags;
    EXPECT_TRUE(near(a.innovation_covariance, b.innovation_covariance, two_routes)) << lags;
    EXPECT_TRUE(near(a.log_density, b.log_density, two_routes)) << lags;
    const HorizonEvaluation c = evaluate_horizons(one.bank, run, {FilterVariant::kf}, {1, 2, 10});
    const HorizonEvaluation d = evaluate_horizons(twice, run, {}, {1, 2, 10});
    EXPECT_TRUE(near(c.log_density, d.log_density, two_routes)) << lags;
  }
}

/// Largest loss of a run [nats] because theta is unknown, if the noise were always the smallest. theta is Gaussian
/// about another theta, with the mean Q of its modes (as in DriftModel). z are the regressors of a transition: log
/// det(I + P0 sum z z' / q) / 2 + |difference|^2 / (2 P0).
double cost_of_learning(const Bank& bank, const Bank& truth, const Trajectory& run, double mean_Q, double least_Q) {
  const Index r = bank.structure.regressors();
  Eigen::MatrixXd known = Eigen::MatrixXd::Identity(r, r);
  const Eigen::VectorXd prior = mean_Q / bank.drift.scale.array().square();
  Eigen::VectorXd z(r);
  for (Index k = 0; k + 1 < run.samples(); ++k) {
    fill_regressor(bank.structure, run.state.col(k), run.input.col(k), z);
    known += prior.asDiagonal() * z * z.transpose() / least_Q;
  }
  const Eigen::VectorXd difference = truth.theta(0) - bank.theta(0);
  return (std::log(known.determinant()) + difference.cwiseAbs2().cwiseQuotient(prior).sum()) / 2.0;
}

TEST(DriftOfOneTheta, WhatOneNoiseLevelLearnsOfThetaAllKnow) {
  Bank bank = exact_bank(1, 1);
  bank.modes.push_back(bank.modes[0]);
  bank.modes[0].Q(0, 0) = 1e-4;
  bank.modes[1].Q(0, 0) = 1e-2;
  bank.transition = TransitionMatrix::sticky(2, 0.98);
  bank.initial_probability.setConstant(2, 0.5);
  Bank moved = bank;
  for (Mode& mode : moved.modes) mode.model.B *= 2.0;
  const Trajectory run = test::simulate_bank(moved, 2000, 6);
  const Bank learning = drifting(bank, {0.0, 1.0, 1.0});
  const double known = log_likelihood(moved, run, {}), still = log_likelihood(bank, run, {});
  const double learned = log_likelihood(learning, run, {});
  const double cost = cost_of_learning(learning, moved, run, (1e-4 + 1e-2) / 2.0, 1e-4);
  EXPECT_LT(still + 10.0 * cost, known);
  EXPECT_GT(learned, known - cost);
  BankFilter filter(learning, {});
  for (Index k = 0; k < run.samples(); ++k) filter.step(run.time_s(k), run.input.col(k), run.state.col(k));
  const Eigen::MatrixXd theta = filter.snapshot().drift.theta;
  ASSERT_EQ(theta.cols(), 1);
  EXPECT_NEAR(theta(1, 0), moved.modes[0].model.B(0, 0), 0.01);
}

TEST(DriftOfOneTheta, NeedsWeights) {
  Bank bank = drifting(exact_bank(1, 1), {0.0, 1.0, 1.0});
  bank.modes.push_back(bank.modes[0]);
  bank.transition = TransitionMatrix::sticky(2, 0.98);
  bank.initial_probability.setConstant(2, 0.5);
  validate(bank);
  for (Mode& mode : bank.modes) mode.weight = 0.0;
  EXPECT_THROW(validate(bank), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
