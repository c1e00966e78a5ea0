// State-dependent transition probabilities: closed forms, laws of the fit, the choice by cross-validation.
#include <gtest/gtest.h>

#include <boost/random/uniform_01.hpp>
#include <cmath>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

constexpr double mode_a[] = {-0.5, -0.1}, mode_b[] = {0.4, -0.3}, mode_sd[] = {0.05, 0.1};

/// Log odds of mode 1 after mode i: offset(i) + slope u.
struct LogOdds {
  Eigen::Vector2d offset;
  double slope;
};

/// x+ = x + a_m x + b_m u + w. The mode of a step is drawn from these odds. No input lies within `gap` of `border`.
Recording state_dependent_runs(const LogOdds& log_odds, Index runs, Index samples, std::uint64_t seed,
                               double border = 0.0, double gap = 0.0) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_01<double> uniform;
  Recording recording = test::empty_recording(1, 1);
  for (Index r = 0; r < runs; ++r) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, samples), u(1, samples);
    int mode = 0;
    for (Index k = 0; k < samples; ++k) {
      u(k) = normal(generator);
      if (std::abs(u(k) - border) < gap) u(k) += u(k) > border ? gap : -gap;
      mode = uniform(generator) < 1.0 / (1.0 + std::exp(-log_odds.offset(mode) - log_odds.slope * u(k))) ? 1 : 0;
      if (k + 1 < samples)
        x(k + 1) = x(k) + mode_a[mode] * x(k) + mode_b[mode] * u(k) + mode_sd[mode] * normal(generator);
    }
    test::add_run(recording, x, u);
  }
  return recording;
}

SwitchingRegression true_model(const LogOdds& log_odds) {
  const Eigen::Array2d p = 1.0 / (1.0 + (-log_odds.offset.array()).exp());
  return {Eigen::MatrixXd{{mode_a[0], mode_a[1]}, {mode_b[0], mode_b[1]}},
          {Eigen::MatrixXd{{mode_sd[0] * mode_sd[0]}}, Eigen::MatrixXd{{mode_sd[1] * mode_sd[1]}}},
          Eigen::MatrixXd{{1.0 - p(0), p(0)}, {1.0 - p(1), p(1)}},
          Eigen::Vector2d(0.5, 0.5),
          {Eigen::MatrixXd{{0.0, -0.5 * log_odds.slope}, {0.0, 0.5 * log_odds.slope}}, Eigen::VectorXd::Zero(2)}};
}

const LogOdds soft{{-2.0, 1.0}, 1.5};

TrainingTransitions rows_of(const Recording& recording) {
  return gather_training_transitions(recording, test::structure_of(recording));
}

Bank bank_of(const Recording& recording, const SwitchingRegression& model) {
  return with_modes(bank_frame(recording, test::structure_of(recording), Eigen::MatrixXd::Zero(1, 1)), model);
}

TEST(TransitionLogit, IsTheLogisticFunctionForTwoModesAndTWhereTheStateIsNotKnown) {
  const auto [theta, Q, T, initial, logit, motion, levels] = true_model(soft);
  TransitionWorkspace at(2, logit);
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(1);
  EXPECT_EQ(transition_at(T, logit, x, std::nan("") * x, at), T);
  for (const double u : {-3.0, 0.0, 0.7, 40.0, 1e3}) {
    const Eigen::MatrixXd& P = transition_at(T, logit, x, u * x, at);
    for (Index i = 0; i < 2; ++i) {
      EXPECT_NEAR(P(i, 1), 1.0 / (1.0 + std::exp(-soft.offset(i) - soft.slope * u)), 1e-14) << u;
      EXPECT_NEAR(P.row(i).sum(), 1.0, 1e-15);
    }
  }
}

TEST(TransitionRegression, LikelihoodIsTheFiltersWithoutMeasurementNoise) {
  const Recording recording = state_dependent_runs(soft, 2, 150, 1);
  const TrainingTransitions t = rows_of(recording);
  const SwitchingRegression model = true_model(soft);
  const double expected = training_log_likelihood(bank_of(recording, model), recording, {});
  const ModePosterior posterior = smooth_modes(t, model);
  EXPECT_NEAR(posterior.log_likelihood, expected, 1e-6);  // the filter has a lower bound on probabilities
  EXPECT_TRUE(near(posterior.pairs.rowwise().sum().reshaped(2, 2), posterior.switches, 1e-11));
}

SwitchingPrior prior_of(const Recording& recording, const TrainingTransitions& t, double width) {
  return switching_prior(t, fit_global(recording, t.structure), {}, 4.0, width);
}

TEST(TransitionRegression, EveryIterationRaisesThePenalisedLikelihood) {
  for (const double width : {1.0, 300.0}) {
    const Recording recording = state_dependent_runs({{-20.0, -20.0}, 100.0}, 3, 200, 3);
    const TrainingTransitions t = rows_of(recording);
    SwitchingRegression start = true_model(soft);
    start.logit = no_effect(t, 2);
    SwitchingFit fit{start};
    iterate(t, prior_of(recording, t, width), {}, 40, fit);
    const std::vector<double>& objective = fit.objective;
    for (std::size_t i = 1; i < objective.size(); ++i)
      EXPECT_GE(objective[i], objective[i - 1] - 1e-9 * std::abs(objective[i - 1])) << width << ", iteration " << i;
    EXPECT_GT(objective.back(), objective.front() + 50.0);
  }
}

/// The objective, computed again here, must fall in every direction.
TEST(TransitionRegression, EndsWhereTheExpectedLogPosteriorIsLargest) {
  const Recording recording = state_dependent_runs(soft, 2, 300, 4);
  const TrainingTransitions t = rows_of(recording);
  const SwitchingPrior prior = prior_of(recording, t, 3.0);
  SwitchingRegression model = true_model(soft);
  const ModePosterior posterior = smooth_modes(t, model);
  for (int i = 0; i < 30; ++i) raise_switching(t, posterior, prior, model);
  const auto value = [&](const SwitchingRegression& at) {
    const Eigen::Matrix2d log_T = at.transition.array().log();
    double sum = prior.counts * log_T.sum() -
                 0.5 * (at.logit.weights * prior.weight_sd.cwiseInverse().asDiagonal()).squaredNorm();
    for (Index k = 0; k < t.count(); ++k) {
      const Eigen::VectorXd z = t.data.regressors.row(k).transpose() - at.logit.reference;
      Eigen::ArrayXXd odds = log_T.rowwise() + (at.logit.weights * z).transpose();
      odds.colwise() -= odds.exp().rowwise().sum().log().eval();
      sum += (posterior.pairs.col(k).reshaped(2, 2).array() * odds).sum();
    }
    return sum;
  };
  for (Index i = 0; i < 2; ++i)
    for (const double step : {-1e-3, 1e-3}) {
      for (Index c = 0; c < 2; ++c) {
        SwitchingRegression moved = model;
        moved.logit.weights(i, c) += step;
        EXPECT_LT(value(moved), value(model));
      }
      SwitchingRegression moved = model;
      moved.transition.row(i) += Eigen::RowVector2d(step, -step) * model.transition(i, 0);
      EXPECT_LT(value(moved), value(model));
    }
}

/// Mode 1 occurs twice, slightly different. The closest pair must become one mode again, with the probabilities of
/// both.
TEST(TransitionRegression, TheClosestPairIsMerged) {
  const Recording recording = state_dependent_runs(soft, 4, 300, 11);
  const TrainingTransitions t = rows_of(recording);
  const SwitchingRegression two = true_model(soft);
  SwitchingRegression three = two;
  three.theta.conservativeResize(Eigen::NoChange, 3);
  three.theta.col(2) = two.theta.col(1) + Eigen::Vector2d(1e-3, -1e-3);
  three.Q.push_back(two.Q[1]);
  three.transition = two.transition(Eigen::Vector3i(0, 1, 1), Eigen::Vector3i(0, 1, 1));
  three.transition.rightCols(2) *= 0.5;
  three.initial = Eigen::Vector3d(0.5, 0.25, 0.25);
  three.logit.weights = two.logit.weights(Eigen::Vector3i(0, 1, 1), Eigen::all);
  SwitchingRegression merged = three;
  merge_closest_pair(t, smooth_modes(t, three), merged);
  ASSERT_EQ(merged.modes(), 2);
  EXPECT_TRUE(near(merged.transition, two.transition, 1e-12));
  EXPECT_TRUE(near(merged.initial, two.initial, 1e-12));
  EXPECT_TRUE(near(merged.logit.weights, two.logit.weights, 1e-12));
  EXPECT_TRUE(near(merged.theta, two.theta, 2e-3));
}

Refinement refined(const Recording& recording, const LogOdds& start) {
  const RefineOptions options{
      .restarts = 0, .folds = 4, .measurement_noise = false, .state_dependent_transition = true};
  SwitchingRegression constant = true_model(start);
  constant.logit = {};
  return refine_bank(recording, test::windows_of(recording, 10, 10), {bank_of(recording, constant)}, options, {});
}

TEST(StateDependentTransition, ASoftBorderAndTheModeBeforeAreFound) {
  const Refinement result = refined(state_dependent_runs(soft, 8, 500, 5), soft);
  ASSERT_GT(result.switching.width, 0.0);
  EXPECT_GT(result.switching.gain, result.switching.gain_standard_error);
  const TransitionLogit& logit = result.bank.transition_logit;
  EXPECT_NEAR(logit.weights(1, 1), 0.5 * soft.slope, 0.2);
  EXPECT_NEAR(logit.weights(1, 0), 0.0, 0.2);
  const Eigen::MatrixXd& T = result.bank.transition.matrix();
  EXPECT_NEAR(std::log(T(0, 0) / T(0, 1)) + std::log(T(1, 1) / T(1, 0)), soft.offset(1) - soft.offset(0), 1.0);
}

TEST(StateDependentTransition, AMarkovChainKeepsItsTransitionMatrix) {
  const Refinement result = refined(state_dependent_runs({{-3.0, 3.0}, 0.0}, 8, 400, 6), {{-3.0, 3.0}, 0.0});
  EXPECT_EQ(result.switching.width, 0.0);
  EXPECT_FALSE(std::isnan(result.switching.gain));
  EXPECT_TRUE(result.bank.transition_logit.empty());
}

/// The border must lie in the gap that inputs leave around it, however wide.
TEST(StateDependentTransition, AHardBorderLiesInTheGap) {
  const double border = 0.4;
  for (const auto& [seed, gap] : {std::pair{7, 0.05}, {8, 0.1}, {9, 0.1}, {10, 0.1}}) {
    const Recording recording = state_dependent_runs({{-1e6 * border, -1e6 * border}, 1e6}, 4, 500,
                                                     static_cast<std::uint64_t>(seed), border, gap);
    const Refinement result = refined(recording, {{-3.0, 3.0}, 0.0});
    ASSERT_GT(result.switching.width, 0.0);
    const TransitionLogit& logit = result.bank.transition_logit;
    const Eigen::MatrixXd& T = result.bank.transition.matrix();
    for (Index i = 0; i < 2; ++i) {
      const double odds = std::log(T(i, 1) / T(i, 0)) - (logit.weights.row(1) - logit.weights.row(0)) * logit.reference;
      EXPECT_NEAR(-odds / (logit.weights(1, 1) - logit.weights(0, 1)), border, gap) << seed;
    }
  }
}

}  // namespace
}  // namespace modebank
