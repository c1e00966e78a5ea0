// Refinement where the states are not measured exactly: theta, Q, R and T together.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "filter/bank_frame.hpp"
#include "filter/refine.hpp"
#include "filter/refine_start.hpp"
#include "filter/switching_state_space.hpp"
#include "filter/training_likelihood.hpp"
#include "tests/filter/learn_test_support.hpp"

namespace modebank {
namespace {

struct SystemTruth {
  Eigen::MatrixXd theta{{-0.2, -0.6}, {0.3, 1.0}};
  Eigen::Vector2d Q{0.01, 0.04};
  Eigen::Matrix2d T{{0.97, 0.03}, {0.04, 0.96}};
  double R = 0.01;
};

/// y = x + v, x[k+1] = x + a x + b u + w in switching modes.
Recording measured_runs(const SystemTruth& truth, Index runs, Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  Recording recording = test::empty_recording(1, 1);
  for (Index i = 0; i < runs; ++i) {
    Eigen::MatrixXd y(1, samples), u(1, samples);
    double x = 0.0;
    Index mode = i % 2;
    for (Index k = 0; k < samples; ++k) {
      y(k) = x + std::sqrt(truth.R) * normal(generator);
      u(k) = normal(generator);
      if (uniform(generator) > truth.T(mode, mode)) mode = 1 - mode;
      x += truth.theta(0, mode) * x + truth.theta(1, mode) * u(k) + std::sqrt(truth.Q(mode)) * normal(generator);
    }
    test::add_run(recording, y, u);
  }
  return recording;
}

Bank bank_of(const Recording& recording, const Eigen::MatrixXd& theta, const Eigen::VectorXd& Q, double R) {
  const LinearStructure structure = test::structure_of(recording);
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Constant(1, 1, R));
  for (Index j = 0; j < theta.cols(); ++j)
    bank.modes.push_back(make_mode(structure, theta.col(j), Eigen::MatrixXd::Constant(1, 1, Q(j)), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix::sticky(theta.cols(), 0.9));
  return bank;
}

SwitchingPrior prior_on(const Recording& recording, const LinearStructure& structure) {
  const TrainingTransitions transitions = gather_training_transitions(recording, structure);
  return switching_prior(transitions, fit_global(recording, structure), {}, 1.0);
}

TEST(StateSpaceSums, AreThoseOfTheRegressionWhereStatesAreMeasuredExactly) {
  SystemTruth truth;
  truth.R = 0.0;
  const Recording recording = measured_runs(truth, 2, 200, 3);
  const Bank bank = bank_of(recording, truth.theta, truth.Q, 1e-12);
  const SwitchingPrior prior = prior_on(recording, bank.structure);
  const TrainingTransitions transitions = gather_training_transitions(recording, bank.structure);
  const SwitchingSums regression =
      sum_transitions(transitions, smooth_modes(transitions, switching_model(bank)), prior);
  const SwitchingSums sums = smooth_states(bank, recording, prior, TimeSteps::repeat).switching;
  constexpr double rounding = 1e-5;  // R = 1e-12 is not quite zero, and unlikely pairs are left out
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_TRUE(sums.modes[j].G.isApprox(regression.modes[j].G, rounding));
    EXPECT_TRUE(sums.modes[j].H.isApprox(regression.modes[j].H, rounding));
    EXPECT_TRUE(sums.modes[j].S.isApprox(regression.modes[j].S, rounding));
    EXPECT_NEAR(sums.modes[j].transitions, regression.modes[j].transitions, rounding * regression.modes[j].transitions);
  }
  EXPECT_TRUE(sums.switches.isApprox(regression.switches, rounding));
  EXPECT_TRUE(sums.first.isApprox(regression.first, rounding));
}

/// One mode, two lags, missing samples and a gap: then there is nothing approximate, and EM's law holds.
TEST(StateSpaceStep, RaisesTheLikelihoodOfOneModeAtEveryStep) {
  SystemTruth truth;
  truth.theta.col(1) = truth.theta.col(0);
  truth.Q(1) = truth.Q(0);
  Recording recording = measured_runs(truth, 3, 150, 5);
  recording.runs[0].state.middleCols(40, 5).setConstant(std::nan(""));
  recording.runs[1].time_s.tail(60).array() += 0.3;
  LinearStructure structure = test::structure_of(recording);
  structure.state_lags = 2;
  Bank bank = bank_frame(recording, structure, Eigen::MatrixXd::Constant(1, 1, 0.04));
  bank.modes.push_back(
      make_mode(structure, Eigen::Vector3d(-0.5, 0.1, 0.5), Eigen::MatrixXd::Constant(1, 1, 0.04), {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix());
  SwitchingPrior prior = prior_on(recording, structure);
  const auto objective = [&] {
    return training_log_likelihood(bank, recording, {}) + log_prior(prior, SharedParts::none, switching_model(bank));
  };
  double before = objective();
  const double first = before;
  for (int i = 0; i < 40; ++i) {
    step_state_space(recording, prior, SharedParts::none, TimeSteps::repeat, Eigen::VectorXd::Zero(1), true, bank);
    const double now = objective();
    EXPECT_GE(now, before - 1e-9 * std::abs(before)) << "step " << i;
    before = now;
  }
  EXPECT_GT(before, first + 10.0);
}

class RefineMeasured : public testing::TestWithParam<Index> {};

/// folds 1: to convergence; more: stopped by cross-validation.
TEST_P(RefineMeasured, RecoversEverythingWithinThreeStandardErrors) {
  const SystemTruth truth;
  const Recording recording = measured_runs(truth, 6, 600, 11);
  const WindowFits fits = test::windows_of(recording, 25, 1);
  RefineOptions options;
  options.restarts = 0;
  options.folds = GetParam();
  const Eigen::MatrixXd theta = truth.theta + Eigen::MatrixXd{{-0.1, 0.1}, {0.05, -0.1}};
  const Refinement refined =
      refine_bank(recording, fits, {bank_of(recording, theta, Eigen::Vector2d(0.03, 0.06), 1e-9)}, options, {});
  const Bank& bank = refined.bank;
  ASSERT_EQ(bank.mode_count(), 2);
  EXPECT_GT(refined.measurement.iterations, 0);
  for (Index j = 0; j < 2; ++j) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    for (Index a = 0; a < 2; ++a)
      EXPECT_LT(std::abs(bank.theta(j)(a) - truth.theta(a, j)), 3.0 * mode.standard_error(a)) << j << ", " << a;
    EXPECT_LT(std::abs(mode.Q(0, 0) - truth.Q(j)), 3.0 * mode.Q_standard_error(0, 0)) << j;
    EXPECT_LT(mode.standard_error.maxCoeff(), 0.06);
    EXPECT_LT(mode.Q_standard_error(0, 0), 0.3 * truth.Q(j));
  }
  ASSERT_EQ(bank.R_standard_error.rows(), 1);
  EXPECT_LT(std::abs(bank.R(0, 0) - truth.R), 3.0 * bank.R_standard_error(0, 0));
  EXPECT_LT(bank.R_standard_error(0, 0), 0.3 * truth.R);
  const Eigen::MatrixXd error = bank.transition.matrix() - truth.T;
  EXPECT_TRUE((error.array().abs() < 3.0 * bank.transition_standard_error.array()).all()) << error;
  EXPECT_LT(bank.transition_standard_error.maxCoeff(), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Folds, RefineMeasured, testing::Values(1, 3));

TEST(RefineMeasured, KeepsAGivenRAndFitsTheRest) {
  const SystemTruth truth;
  const Recording recording = measured_runs(truth, 4, 400, 13);
  RefineOptions options;
  options.restarts = 0;
  options.folds = 1;
  options.measurement_noise = false;
  const Bank start = bank_of(recording, truth.theta, Eigen::Vector2d(0.03, 0.06), truth.R);
  const Bank bank = refine_bank(recording, test::windows_of(recording, 25, 1), {start}, options, {}).bank;
  EXPECT_EQ(bank.R(0, 0), truth.R);
  EXPECT_EQ(bank.R_standard_error.size(), 0);
  for (Index j = 0; j < 2; ++j) {
    const Mode& mode = bank.modes[static_cast<std::size_t>(j)];
    EXPECT_LT(std::abs(mode.Q(0, 0) - truth.Q(j)), 3.0 * mode.Q_standard_error(0, 0)) << j;
  }
}

}  // namespace
}  // namespace modebank
