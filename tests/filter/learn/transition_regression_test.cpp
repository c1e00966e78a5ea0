// State-dependent transition probabilities: closed forms, the filter's likelihood, laws of the fit.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/likelihood/standard_errors.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/logit.hpp"
#include "filter/learn/switching/screening.hpp"
#include "filter/step/bank_filter.hpp"
#include "tests/filter/learn/state_dependent_runs.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::bank_of;
using test::near;
using test::soft;
using test::state_dependent_runs;
using test::true_model;

TEST(TransitionLogit, IsTheLogisticFunctionForTwoModes) {
  const TransitionLogit logit = true_model(soft).logit;
  TransitionWorkspace at(2, logit);
  for (const double u : {-3.0, 0.0, 0.7, 40.0, 1e3}) {
    const Eigen::MatrixXd& P = transition_at(true_model(soft).transition, logit, Eigen::VectorXd::Ones(1),
                                             Eigen::VectorXd::Constant(1, u), at);
    for (Index i = 0; i < 2; ++i) {
      EXPECT_NEAR(P(i, 1), 1.0 / (1.0 + std::exp(-soft.offset(i) - soft.slope * u)), 1e-14) << u;
      EXPECT_NEAR(P.row(i).sum(), 1.0, 1e-15);
    }
  }
}

TEST(TransitionLogit, IsTWithoutWeightsAndWhereTheStateIsNotKnown) {
  const SwitchingRegression model = true_model(soft);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1), unknown = Eigen::VectorXd::Constant(1, std::nan(""));
  TransitionWorkspace none(2, {}), some(2, model.logit);
  EXPECT_EQ(transition_at(model.transition, {}, one, one, none), model.transition);
  EXPECT_EQ(transition_at(model.transition, model.logit, one, unknown, some), model.transition);
}

TEST(TransitionRegression, LikelihoodIsTheFiltersWithoutMeasurementNoise) {
  const Recording recording = state_dependent_runs(soft, 2, 150, 1);
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  const SwitchingRegression model = true_model(soft);
  const double expected = training_log_likelihood(bank_of(recording, t, model), recording, {});
  EXPECT_NEAR(smooth_modes(t, model).log_likelihood, expected, 1e-6);  // the filter has a lower bound on probabilities
}

TEST(TransitionRegression, NoEffectIsTheConstantTransitionMatrix) {
  const Recording recording = state_dependent_runs(soft, 2, 100, 2);
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  SwitchingRegression model = true_model(soft);
  model.logit = {};
  const ModePosterior constant = smooth_modes(t, model);
  model.logit = no_effect(t, 2);
  const ModePosterior logit = smooth_modes(t, model);
  EXPECT_NEAR(logit.log_likelihood, constant.log_likelihood, 1e-12 * std::abs(constant.log_likelihood));
  EXPECT_TRUE(near(logit.switches, constant.switches, 1e-11));
  EXPECT_TRUE(near(logit.pairs.rowwise().sum().reshaped(2, 2), constant.switches, 1e-11));
}

SwitchingPrior prior_of(const Recording& recording, const TrainingTransitions& t, double width) {
  return with_logit_prior(switching_prior(t, fit_global(recording, t.structure), {}, 4.0), t, width);
}

TEST(TransitionRegression, EveryIterationRaisesThePenalisedLikelihood) {
  for (const double width : {1.0, 300.0}) {
    const Recording recording = state_dependent_runs({{-20.0, -20.0}, 100.0}, 3, 200, 3);
    const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
    const SwitchingPrior prior = prior_of(recording, t, width);
    SwitchingRegression start = true_model(soft);
    start.logit = no_effect(t, 2);
    ExpectationMaximisation em(t, prior, {}, start);
    for (int i = 0; i < 40; ++i) em.step();
    const std::vector<double>& objective = em.objective();
    for (std::size_t i = 1; i < objective.size(); ++i)
      EXPECT_GE(objective[i], objective[i - 1] - 1e-9 * std::abs(objective[i - 1])) << width << ", iteration " << i;
    EXPECT_GT(objective.back(), objective.front() + 50.0);
  }
}

/// At the maximum a Newton step gains nothing. The objective is computed again here; it must fall in every direction.
TEST(TransitionRegression, EndsWhereTheExpectedLogPosteriorIsLargest) {
  const Recording recording = state_dependent_runs(soft, 2, 300, 4);
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  const SwitchingPrior prior = prior_of(recording, t, 3.0);
  SwitchingRegression model = true_model(soft);
  const ModePosterior posterior = smooth_modes(t, model);
  for (int i = 0; i < 30; ++i) raise_switching(t, posterior, prior, model);
  const auto value = [&](const SwitchingRegression& at) {
    const Eigen::Matrix2d log_T = at.transition.array().log();
    double sum = prior.counts * log_T.sum();
    for (Index c = 0; c < 2; ++c)
      for (Index j = 0; j < 2; ++j) sum -= 0.5 * std::pow(at.logit.weights(j, c) / prior.weight_sd(c), 2);
    for (Index k = 0; k < t.count(); ++k)
      for (Index i = 0; i < 2; ++i) {
        const Eigen::VectorXd z = t.data.regressors.row(k).transpose() - at.logit.reference;
        Eigen::VectorXd odds = at.transition.row(i).transpose().array().log().matrix() + at.logit.weights * z;
        const double total = std::log(odds.array().exp().sum());
        for (Index j = 0; j < 2; ++j) sum += posterior.pairs(i + 2 * j, k) * (odds(j) - total);
      }
    return sum;
  };
  const double best = value(model);
  for (Index j = 0; j < 2; ++j)
    for (Index c = 0; c < 2; ++c)
      for (const double step : {-1e-3, 1e-3}) {
        SwitchingRegression moved = model;
        moved.logit.weights(j, c) += step;
        EXPECT_LT(value(moved), best);
      }
  for (Index i = 0; i < 2; ++i)
    for (const double factor : {0.999, 1.001}) {
      SwitchingRegression moved = model;
      moved.transition(i, 0) *= factor;
      moved.transition(i, 1) = 1.0 - moved.transition(i, 0);
      EXPECT_LT(value(moved), best);
    }
}

/// Mode 1 occurs twice, in slightly different form. The closest pair must become one mode again, with the probabilities
/// of both.
TEST(TransitionRegression, TheClosestPairIsMerged) {
  const Recording recording = state_dependent_runs(soft, 4, 300, 11);
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  const SwitchingRegression two = true_model(soft);
  SwitchingRegression three = two;
  three.theta.conservativeResize(Eigen::NoChange, 3);
  three.theta.col(2) = two.theta.col(1) + Eigen::Vector2d(1e-3, -1e-3);
  three.Q.push_back(two.Q[1]);
  three.transition = two.transition(Eigen::Vector3i(0, 1, 1), Eigen::Vector3i(0, 1, 1));
  three.transition.rightCols(2) *= 0.5;
  three.initial = Eigen::Vector3d(0.5, 0.25, 0.25);
  three.logit.weights = two.logit.weights(Eigen::Vector3i(0, 1, 1), Eigen::all);
  const SwitchingRegression merged = with_closest_pair_merged(t, smooth_modes(t, three), three);
  ASSERT_EQ(merged.modes(), 2);
  EXPECT_TRUE(near(merged.transition, two.transition, 1e-12));
  EXPECT_TRUE(near(merged.initial, two.initial, 1e-12));
  EXPECT_TRUE(near(merged.logit.weights, two.logit.weights, 1e-12));
  EXPECT_TRUE(near(merged.theta, two.theta, 2e-3));
}

}  // namespace
}  // namespace modebank
