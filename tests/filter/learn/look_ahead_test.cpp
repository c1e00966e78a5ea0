// Look-ahead learning: its scores, and the prior towards one motion.
#include <cmath>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/learn/likelihood/training_likelihood.hpp"
#include "filter/learn/switching/em.hpp"
#include "filter/learn/switching/starts.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/fit/global_model.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/free_run_test_support.hpp"
#include "tests/filter/learn/refine_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_bank;
using test::near;
using test::quick;
using test::simulate_bank;
using test::start_bank;

TEST(LookAhead, OneSampleIsTheLikelihoodBitForBit) {
  const Bank bank = example_bank(2, 1, 3);
  Trajectory run = simulate_bank(bank, 150, 3);
  run.state(0, 40) = not_a_number;
  EXPECT_EQ(look_ahead_score(bank, run, {}, {}), log_likelihood(bank, run, {}));
  EXPECT_TRUE(near(look_ahead_scores(bank, run, {}, {}), log_densities(bank, run, {}), 0.0));
}

TEST(LookAhead, IsTheMeanOfTheHorizonsDensities) {
  const Bank bank = example_bank(1, 2, 3);
  const Trajectory run = simulate_bank(bank, 90, 5);
  for (const Index h : {2, 4, 7}) {
    std::vector<Index> horizons;
    for (Index j = 1; j <= h; ++j) horizons.push_back(j);
    const Eigen::MatrixXd density = evaluate_horizons(bank, run, {}, horizons).log_density;
    const Index stride = (h + 3) / 4;
    Eigen::VectorXd expected = density.row(0);
    for (Index k = 1; k < run.samples(); ++k)
      for (Index j = 2; j <= std::min(h, k); ++j)
        if ((k - j) % stride == 0) expected(k) += static_cast<double>(stride) * density(j - 1, k);
    const Eigen::VectorXd counted = look_ahead_scores(bank, run, {}, {h});
    EXPECT_TRUE(near(counted.tail(89), expected.tail(89) / static_cast<double>(h), 1e-10)) << h;
  }
  EXPECT_THROW(look_ahead_scores(bank, run, {}, {0}), std::invalid_argument);
}

TEST(LookAhead, OrMinusHalfTheSquaresOfTheHorizonsErrors) {
  const Bank bank = example_bank(2, 1, 3);
  const Trajectory run = simulate_bank(bank, 60, 5);
  const LookAhead look{4, Eigen::Vector2d(0.5, 2.0)};
  const HorizonEvaluation horizons = evaluate_horizons(bank, run, {}, {1, 2, 3, 4});
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(60);
  for (Index k = 1; k < 60; ++k)
    for (Index j = 1; j <= std::min<Index>(4, k); ++j)
      expected(k) -=
          0.5 / 4.0 *
          horizons.error[static_cast<std::size_t>(j - 1)].col(k).cwiseQuotient(look.error_unit).squaredNorm();
  EXPECT_TRUE(near(look_ahead_scores(bank, run, {}, look), expected, 1e-10));
  EXPECT_NEAR(look_ahead_score(bank, run, {}, look), expected.sum(), 1e-9);
}

TEST(LookAhead, OfLaggedModelsIsThePlainRecursions) {
  const LinearStructure s{1, 1, true, 3, 2};
  const Eigen::VectorXd theta = test::stable_theta(s);
  const Trajectory run = test::any_run(s, 50);
  const Index h = 9, stride = (h + 3) / 4;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(50);
  for (Index origin = s.first_transition(); origin + 1 < 50; origin += stride) {
    Eigen::VectorXd y = run.state.row(0).transpose();
    for (Index k = origin + 1; k < std::min<Index>(50, origin + h + 1); ++k) {
      Eigen::VectorXd z(6);
      z << y(k - 1), y(k - 2), y(k - 3), run.input(0, k - 1), run.input(0, k - 2), 1.0;
      y(k) = y(k - 1) + theta.dot(z);
      expected(k) -= 0.5 * static_cast<double>(stride) / static_cast<double>(h) * std::pow(run.state(0, k) - y(k), 2);
    }
  }
  const LookAhead look{h, Eigen::VectorXd::Ones(1)};
  EXPECT_TRUE(near(look_ahead_scores(test::arx_bank(s, theta), run, {}, look), expected, 1e-10));
}

using LookAheadLearning = test::RefineTest;

TEST_F(LookAheadLearning, PullWithoutEndLeavesOneMotion) {
  learn_from(3, 300);
  const TrainingTransitions transitions = gather_training_transitions(recording, test::structure_of(recording));
  const GlobalModel global = fit_global(recording, transitions.structure);
  const SwitchingPrior prior = switching_prior(transitions, global, {}, 4.0);
  const SwitchingRegression start = switching_model(start_bank(recording, truth.theta));
  EXPECT_EQ(towards_one_motion(prior, transitions, start, 0.0, {}).information, prior.information);
  const auto spread = [&](double pull) {
    const SwitchingPrior drawn = towards_one_motion(prior, transitions, start, pull, {});
    ExpectationMaximisation em(transitions, drawn, {}, start);
    for (int i = 0; i < 20; ++i) em.step();
    return (em.model().theta.colwise() - drawn.mean).cwiseAbs().maxCoeff();
  };
  EXPECT_GT(spread(1.0), 0.1);
  EXPECT_LT(spread(1e3), spread(1.0));
  EXPECT_LT(spread(1e8), 1e-4);
}

/// y = x + v; the noise in v has the size of the noise in x. A model with exact states that is best one step ahead
/// decays too fast for longer predictions.
Recording measured_with_noise(std::uint64_t seed, Index runs) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Recording recording = test::empty_recording(1, 1);
  for (Index i = 0; i < runs; ++i) {
    Eigen::MatrixXd y(1, 300), u(1, 300);
    double x = 0.0, input = 0.0;
    for (Index k = 0; k < 300; ++k) {
      if (k % 25 == 0) input = normal(generator);
      y(k) = x + 0.5 * normal(generator);
      u(k) = input;
      x += -0.05 * x + 0.1 * input + 0.1 * normal(generator);
    }
    test::add_run(recording, y, u, i < runs / 2 ? Role::train : Role::test);
  }
  return recording;
}

TEST(LookAheadFit, PredictsFartherOnRunsItHasNotSeen) {
  const Recording recording = measured_with_noise(11, 12);
  const WindowFits fits = test::windows_of(recording, 25, 5);
  RefineOptions options = quick();
  options.folds = 3;
  options.measurement_noise = false;
  const auto score = [&](Index look_ahead) {
    options.look_ahead = look_ahead;
    const Refinement refined = refine_bank(recording, fits, {start_bank(recording, fits.global.theta)}, options, {});
    EXPECT_EQ(refined.look_ahead.taken, look_ahead > 1);
    EXPECT_EQ(refined.bank.modes.front().standard_error.allFinite(), look_ahead == 1) << "errors are stated or not";
    double sum = 0.0;
    for (const Trajectory& run : recording.runs) {
      if (run.role != Role::test) continue;
      const HorizonEvaluation ahead = evaluate_horizons(refined.bank, run, {}, {8});
      sum += ahead.log_density.array().isNaN().select(0.0, ahead.log_density).sum();
    }
    return sum / static_cast<double>(recording.transitions(Role::test));
  };
  EXPECT_GT(score(8), score(1) + 0.05);
}

TEST(LookAheadFit, ByErrorsFindsTheSystemBehindNoiseThatIsNoStates) {
  const Recording recording = measured_with_noise(11, 12);
  const WindowFits fits = test::windows_of(recording, 25, 5);
  RefineOptions options = quick();
  options.measurement_noise = false;
  const auto pole_and_gain = [&](Index look_ahead, Index folds) {
    options.look_ahead = look_ahead;
    options.look_ahead_score = look_ahead > 1 ? LookAheadScore::error : LookAheadScore::density;
    options.folds = folds;
    const Refinement refined = refine_bank(recording, fits, {start_bank(recording, fits.global.theta)}, options, {});
    EXPECT_EQ(refined.look_ahead.taken, look_ahead > 1);
    const Mode& mode = refined.bank.modes.front();
    const double one_step = mode.Q(0, 0);
    EXPECT_GT(one_step, 0.25) << "Q is what is left one step ahead, all noise together";
    EXPECT_LT(one_step, 0.6);
    return Eigen::Vector2d(mode.model.A(0, 0), mode.model.B(0, 0));
  };
  const Eigen::Vector2d truth(-0.05, 0.1);
  EXPECT_GT((pole_and_gain(1, 3) - truth).norm(), 0.2) << "errors in variables";
  EXPECT_LT((pole_and_gain(40, 3) - truth).norm(), 0.02);
  EXPECT_LT((pole_and_gain(40, 1) - truth).norm(), 0.02) << "asks nobody";
}

}  // namespace
}  // namespace modebank
