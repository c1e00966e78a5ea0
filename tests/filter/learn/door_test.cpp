#include <gtest/gtest.h>

#include "filter/learn/learn.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/linearise.hpp"
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

/// What the chain's stages make of the recording, one after the other.
struct Expected {
  Baseline baseline;
  Refinement learned;
};

Expected by_hand(const Recording& recording, LearnOptions options) {
  options.window.seed = options.bank.em.seed = options.seed;
  options.bank.em.most_modes = most_components(options.mixture.selection);
  const WindowFits fits = fit_windows(recording, options.window);
  const ClusterOptions& cluster = options.mixture;
  const FeatureCloud cloud =
      make_features(fits, cluster.features, cluster.windows, recording.states, cluster.straddling);
  const MixtureResult mixture = select_mixture(fits, cloud, cluster.selection, options.seed);
  const auto motion = motion_model(options.window, recording.state_count(), recording.input_count());
  const GlobalModel global = motion ? linearise(*motion, fits.global, operating_point(recording)) : fits.global;
  Baseline baseline = learn_baseline(recording, global, fits.structure);
  const Eigen::MatrixXd R = baseline.bank.R;
  if (options.bank.refine == Refine::em)
    return {baseline, learn_refined_bank(recording, fits, mixture, options.bank, R, options.filter)};
  return {baseline, {learn_bank(recording, fits, mixture, options.bank, R, motion.get()), {}, {}, {}, {}}};
}

void expect_same(const learn::Learned& outside, const Recording& recording, const LearnOptions& options) {
  const Expected expected = by_hand(recording, options);
  const Bank &bank = expected.learned.bank, &found = outside.bank.internal();
  ASSERT_EQ(found.mode_count(), bank.mode_count());
  for (std::size_t j = 0; j < bank.modes.size(); ++j) {
    EXPECT_EQ(found.theta(static_cast<Index>(j)), bank.theta(static_cast<Index>(j)));
    EXPECT_EQ(found.modes[j].Q, bank.modes[j].Q);
    const Eigen::VectorXd errors = view(outside.uncertainty.theta_standard_error).col(static_cast<Index>(j));
    EXPECT_TRUE(test::same_bits(to_vector(errors), to_vector(bank.modes[j].standard_error)));
  }
  EXPECT_EQ(found.R, bank.R);
  EXPECT_EQ(found.transition.matrix(), bank.transition.matrix());
  EXPECT_EQ(found.state_names, bank.state_names);
  EXPECT_EQ(outside.baseline.internal().R, expected.baseline.bank.R);
  EXPECT_EQ(outside.baseline_log_likelihood, expected.baseline.log_likelihood);
  EXPECT_EQ(outside.log_likelihood, training_log_likelihood(bank, recording, options.filter));
  EXPECT_EQ(outside.origin.objective, expected.learned.objective);
  EXPECT_EQ(outside.origin.refinements.size(), expected.learned.candidates.size());
}

TEST(LearnDoor, GivesTheSameBits) {
  const Recording recording = two_modes();
  for (const Refine refine : {Refine::none, Refine::em}) {
    const LearnOptions options = few_candidates(refine);
    const learn::Learned learned = learn::learn_bank(test::recorded_runs(recording), options);
    expect_same(learned, recording, options);
    EXPECT_EQ(learned.uncertainty.Q_standard_error.empty(), refine == Refine::none);
    EXPECT_GT(learned.log_likelihood, learned.baseline_log_likelihood) << "there are two modes";
    EXPECT_EQ(std::ssize(learned.origin.labels), learned.origin.windows.ceres + learned.origin.windows.batch);
  }
}

TEST(LearnDoor, TakesMotionModels) {
  const Eigen::VectorXd both_tracks{{-1.0, 0.0, 0.5, 0.5, 0.0, -1.0, -1.0, 1.0}};  // centres of rotation at +-0.5 m
  const Bank truth = test::true_bank({2, 2, false}, both_tracks, {1e-4 * Eigen::Matrix2d::Identity()},
                                     Eigen::Vector2d::Constant(1e-6), 1.0);
  const Recording recording = test::simulated_recording(truth, 2, 200, 8);
  LearnOptions options = few_candidates(Refine::none);
  options.window.model = "icr";
  const learn::Learned by_name = learn::learn_bank(test::recorded_runs(recording), options);
  expect_same(by_name, recording, options);
  ASSERT_FALSE(by_name.uncertainty.motion_parameter_names.empty());

  const auto model = motion_model(options.window, 2, 2);
  LearnOptions unnamed = options;
  unnamed.window.model = "linear";
  const learn::Learned own = learn::learn_bank(test::recorded_runs(recording), unnamed, *model);
  EXPECT_TRUE(test::same_bits(own.uncertainty.motion_theta, by_name.uncertainty.motion_theta));
  options.bank.refine = Refine::em;
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(recording), options), ConfigurationError);
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
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(two_modes()), options), ConfigurationError);
  options = {};
  options.bank.noise = NoiseSource::fixed;
  options.bank.process_variance = -1.0;
  EXPECT_THROW(learn::learn_bank(test::recorded_runs(two_modes()), options), ConfigurationError);
  EXPECT_THROW(learn::learn_bank({}), ConfigurationError);
}

}  // namespace
}  // namespace modebank
