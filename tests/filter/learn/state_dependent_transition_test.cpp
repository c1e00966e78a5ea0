// State-dependent transition probabilities, chosen by cross-validation. Soft and hard borders are found. A Markov chain
// keeps its constant T.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/learn/refine/refine.hpp"
#include "tests/filter/learn/state_dependent_runs.hpp"

namespace modebank {
namespace {

using test::bank_of;
using test::LogOdds;
using test::soft;
using test::state_dependent_runs;
using test::true_model;

RefineOptions quick_transition() {
  RefineOptions options;
  options.restarts = 0;
  options.folds = 4;
  options.measurement_noise = false;
  options.state_dependent_transition = true;
  return options;
}

Refinement refined(const Recording& recording, const LogOdds& start) {
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  SwitchingRegression constant = true_model(start);
  constant.logit = {};
  WindowFits fits = test::windows_of(recording, 10, 10);
  return refine_bank(recording, fits, {bank_of(recording, t, constant)}, quick_transition(), {});
}

TEST(StateDependentTransition, ASoftBorderIsFoundWithinItsErrors) {
  const Recording recording = state_dependent_runs(soft, 8, 500, 5);
  const Refinement result = refined(recording, soft);
  ASSERT_GT(result.switching.width, 0.0);
  EXPECT_GT(result.switching.gain, result.switching.gain_standard_error);
  const TransitionLogit& logit = result.bank.transition_logit;
  const Eigen::MatrixXd& error = result.bank.transition_weight_error;
  ASSERT_TRUE(error.allFinite());
  EXPECT_NEAR(logit.weights(1, 1), 0.5 * soft.slope, 3.0 * error(1, 1));
  EXPECT_NEAR(logit.weights(1, 0), 0.0, 3.0 * error(1, 0));
  EXPECT_LT(error(1, 1), 0.3);
}

double log_odds_of_staying(const Bank& bank) {
  const Eigen::MatrixXd& T = bank.transition.matrix();
  return std::log(T(0, 0) / T(0, 1)) + std::log(T(1, 1) / T(1, 0));
}

/// If the input alone determines the mode, the borders do not depend on the previous mode. Otherwise they do.
TEST(StateDependentTransition, TheModeBeforeCountsWhereItMatters) {
  const Refinement without = refined(state_dependent_runs({{-0.4e6, -0.4e6}, 1e6}, 8, 400, 7), {{-3.0, 3.0}, 0.0});
  EXPECT_LT(without.switching.memory_sd, 1.0);
  EXPECT_LT(std::abs(log_odds_of_staying(without.bank)), 0.5);
  const Refinement with = refined(state_dependent_runs(soft, 8, 500, 5), soft);
  EXPECT_TRUE(std::isinf(with.switching.memory_sd));
  EXPECT_NEAR(log_odds_of_staying(with.bank), 3.0, 1.0);
}

TEST(StateDependentTransition, AMarkovChainKeepsItsTransitionMatrix) {
  const Recording recording = state_dependent_runs({{-3.0, 3.0}, 0.0}, 8, 400, 6);
  const Refinement result = refined(recording, {{-3.0, 3.0}, 0.0});
  EXPECT_EQ(result.switching.width, 0.0);
  EXPECT_FALSE(std::isnan(result.switching.gain));
  EXPECT_TRUE(result.bank.transition_logit.empty());
}

TEST(StateDependentTransition, OfAHardBorderNoErrorIsStatedAndTheBorderLiesInTheGap) {
  const double border = 0.4;
  const Recording recording = state_dependent_runs({{-1e6 * border, -1e6 * border}, 1e6}, 8, 400, 7);
  const Refinement result = refined(recording, {{-3.0, 3.0}, 0.0});
  ASSERT_GT(result.switching.width, 0.0);
  EXPECT_TRUE(result.bank.transition_weight_error.array().isNaN().all());
  const TransitionLogit& logit = result.bank.transition_logit;
  const Eigen::MatrixXd& T = result.bank.transition.matrix();
  for (Index i = 0; i < 2; ++i) {
    const double odds = std::log(T(i, 1) / T(i, 0)) - (logit.weights.row(1) - logit.weights.row(0)) * logit.reference;
    EXPECT_NEAR(-odds / (logit.weights(1, 1) - logit.weights(0, 1)), border, 0.05);
  }
}

/// In such a gap the curvature of the likelihood comes only from the prior, so no standard error may be given.
TEST(StateDependentTransition, OfAHardBorderNoErrorIsStatedWhereInputsLeaveAGap) {
  const double border = 0.4, gap = 0.1;
  for (const std::uint64_t seed : {8, 9, 10}) {
    const Recording recording = state_dependent_runs({{-1e6 * border, -1e6 * border}, 1e6}, 4, 500, seed, border, gap);
    const Refinement result = refined(recording, {{-3.0, 3.0}, 0.0});
    ASSERT_GT(result.switching.width, 0.0);
    EXPECT_TRUE(result.bank.transition_weight_error.array().isNaN().all()) << seed;
    const TransitionLogit& logit = result.bank.transition_logit;
    const Eigen::MatrixXd& T = result.bank.transition.matrix();
    for (Index i = 0; i < 2; ++i) {
      const double odds = std::log(T(i, 1) / T(i, 0)) - (logit.weights.row(1) - logit.weights.row(0)) * logit.reference;
      EXPECT_NEAR(-odds / (logit.weights(1, 1) - logit.weights(0, 1)), border, gap);
    }
  }
}

}  // namespace
}  // namespace modebank
