#include <gtest/gtest.h>

#include <stdexcept>

#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"
#include "modebank/learn/learn.hpp"
#include "tests/filter/learn/refine_recovery.hpp"
#include "tests/support/recorded_runs.hpp"

namespace modebank {
namespace {

Recording two_modes() { return test::simulated_recording(test::true_scalar(0.1), 4, 250, 3); }

LearnOptions few_candidates(Refine refine) {
  LearnOptions options;
  options.mixture.selection.components = {1, 2, 3};
  options.bank.refine = refine;
  options.bank.em.max_iterations = 20;
  options.bank.em.restarts = 1;
  options.seed = 4;
  return options;
}

TEST(LearnDoor, TakesMotionModels) {
  const Eigen::VectorXd both_tracks{{-1.0, 0.0, 0.5, 0.5, 0.0, -1.0, -1.0, 1.0}};  // centres of rotation at +-0.5 m
  const Bank truth = test::true_bank({2, 2, false}, both_tracks, {1e-4 * Eigen::Matrix2d::Identity()},
                                     Eigen::Vector2d::Constant(1e-6), 1.0);
  const Recording recording = test::simulated_recording(truth, 2, 200, 8);
  LearnOptions options = few_candidates(Refine::none);
  options.window.model = "icr";
  const learn::Learned by_name = learn::learn_bank(test::recorded_runs(recording), options);
  ASSERT_FALSE(by_name.uncertainty.motion_parameter_names.empty());

  const auto model = motion_model(options.window, 2, 2);
  LearnOptions unnamed = options;
  unnamed.window.model = "linear";
  const learn::Learned own = learn::learn_bank(test::recorded_runs(recording), unnamed, *model);
  EXPECT_TRUE(test::same_bits(own.uncertainty.motion_theta, by_name.uncertainty.motion_theta));
  options.bank.refine = Refine::em;
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(recording), options), std::invalid_argument);
}

TEST(LearnDoor, FindsTwoModesAndTheirErrors) {
  LearnOptions options = few_candidates(Refine::automatic);
  const learn::Learned learned = learn::learn_bank(test::recorded_runs(two_modes()), options);
  EXPECT_EQ(learned.bank.modes(), 2);
  EXPECT_FALSE(learned.uncertainty.Q_standard_error.empty());
  EXPECT_GT(learned.log_likelihood, learned.baseline_log_likelihood);
  EXPECT_FALSE(learned.origin.labels.empty());
  EXPECT_FALSE(learned.origin.refinements.empty());
}

TEST(LearnDoor, ASingleFilterIsTheBaseline) {
  LearnOptions options = few_candidates(Refine::none);
  options.filter.variant = FilterVariant::kf;
  const learn::Learned learned = learn::learn_bank(test::recorded_runs(two_modes()), options);
  EXPECT_EQ(learned.bank.modes(), 1);
  EXPECT_EQ(learned.bank.internal().R, learned.baseline.internal().R);
}

TEST(LearnDoor, BadArgumentsAreNamed) {
  LearnOptions options;
  options.window.step = 0;
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(two_modes()), options), std::invalid_argument);
  options = {};
  options.bank.process_variance = -1.0;
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(two_modes()), options), std::invalid_argument);
  EXPECT_THROW(learn::learn_bank({}), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
