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

TEST(StateDependentTransition, ASoftBorderAndTheModeBeforeAreFound) {
  const Recording recording = state_dependent_runs(soft, 8, 500, 5);
  const Refinement result = refined(recording, soft);
  ASSERT_GT(result.switching.width, 0.0);
  EXPECT_GT(result.switching.gain, result.switching.gain_standard_error);
  const TransitionLogit& logit = result.bank.transition_logit;
  EXPECT_NEAR(logit.weights(1, 1), 0.5 * soft.slope, 0.2);
  EXPECT_NEAR(logit.weights(1, 0), 0.0, 0.2);
  const Eigen::MatrixXd& T = result.bank.transition.matrix();
  EXPECT_NEAR(std::log(T(0, 0) / T(0, 1)) + std::log(T(1, 1) / T(1, 0)), soft.offset(1) - soft.offset(0), 1.0);
}

TEST(StateDependentTransition, AMarkovChainKeepsItsTransitionMatrix) {
  const Recording recording = state_dependent_runs({{-3.0, 3.0}, 0.0}, 8, 400, 6);
  const Refinement result = refined(recording, {{-3.0, 3.0}, 0.0});
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
