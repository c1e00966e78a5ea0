// With measurement noise, refinement ends at the maximum of the filter's likelihood. This maximum recovers the true
// parameters.
#include "tests/filter/learn/refine_recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "filter/learn/switching/em.hpp"

namespace modebank {
namespace {

using test::refine_blurred;
using test::simulated_recording;

/// A prior that only fixes theta at the global model's theta, as in the baseline.
SwitchingPrior theta_known(const Recording& recording, const LinearStructure& structure) {
  const TrainingTransitions transitions = gather_training_transitions(recording, structure);
  SwitchingPrior prior = switching_prior(transitions, fit_global(recording, structure), {}, 0.0);
  prior.information *= 1e12;
  prior.counts = 0.0;
  return prior;
}

FreeParameters everything(const Bank& bank, double theta_unit) {
  FreeParameters free;
  free.theta_unit = Eigen::MatrixXd::Constant(bank.structure.parameters(), bank.mode_count(), theta_unit);
  for (Index i = 0; i < bank.R.rows(); ++i) free.R.push_back(i);
  free.least_R = Eigen::VectorXd::Zero(bank.R.rows());
  free.transition = bank.mode_count() > 1;
  return free;
}

/// For one mode the likelihood is exact. The baseline maximises it over Q and R by another method.
TEST(MaximiseLikelihood, OfOneModeReachesTheBaselinesMaximum) {
  const Bank truth = test::true_pendulum({1.0}, 1.0);
  const Recording recording = simulated_recording(truth, 2, 800, 3);
  const Baseline baseline = learn_baseline(recording, fit_global(recording, truth.structure), truth.structure);
  ASSERT_TRUE(baseline.converged);
  Bank bank = baseline.bank;
  bank.modes[0].Q *= 4.0;
  bank.R *= 0.3;
  const LikelihoodTarget target{recording, {}, theta_known(recording, truth.structure)};
  const LikelihoodMaximum maximum = maximise_likelihood(target, everything(bank, 1e-3), bank, {200, 1e-10});
  EXPECT_EQ(maximum.end, MeasuredFit::converged);
  bank = maximum.bank;
  EXPECT_NEAR(training_log_likelihood(bank, recording, {}), baseline.log_likelihood, 1e-4);
  constexpr double near_enough = 1e-2;  // a hundredth of each parameter is far below the parameter's standard error
  EXPECT_TRUE(bank.modes[0].Q.isApprox(baseline.bank.modes[0].Q, near_enough)) << bank.modes[0].Q;
  EXPECT_NEAR(bank.modes[0].Q(0, 0), baseline.bank.modes[0].Q(0, 0), near_enough * bank.modes[0].Q(0, 0));
  EXPECT_NEAR(bank.R(0, 0), baseline.bank.R(0, 0), near_enough * bank.R(0, 0));
  EXPECT_NEAR(bank.R(1, 1), baseline.bank.R(1, 1), near_enough * bank.R(1, 1));
}

/// At a maximum no step in either direction gains. Tested for several numbers of modes.
TEST(MaximiseLikelihood, EndsWhereNoStepGains) {
  const Bank truth = test::true_pair(1.0);
  const Recording recording = simulated_recording(truth, 3, 300, 5);
  const TrainingTransitions transitions = gather_training_transitions(recording, truth.structure);
  const LikelihoodTarget target{
      recording, {}, switching_prior(transitions, fit_global(recording, truth.structure), {}, 0.01)};
  const LikelihoodMaximum maximum = maximise_likelihood(target, everything(truth, 0.01), truth, {});
  EXPECT_EQ(maximum.end, MeasuredFit::converged);
  EXPECT_EQ(maximum.value, target.value(maximum.bank));
  EXPECT_GT(maximum.value, target.value(truth));
  const BankCoordinates around(maximum.bank, everything(truth, 0.01));
  for (Index c = 0; c < around.size(); ++c)
    for (const double step : {-0.03, 0.03}) {
      const Eigen::VectorXd at = step * Eigen::VectorXd::Unit(around.size(), c);
      EXPECT_LT(target.value(around.decode(at)), maximum.value + 1e-3) << c << ", " << step;
    }
}

/// If modes hardly move, a starting value of R (a share of Q) is below R's bound for some outputs. Variances must not
/// become negative.
TEST(BankCoordinates, KeepRAtItsBound) {
  Bank truth = test::true_pair(1.0);
  FreeParameters noise;
  noise.R = {0, 1};
  noise.least_R = Eigen::Vector2d(0.01, 0.01);
  noise.transition = false;
  truth.R.diagonal() << 0.005, 0.02;
  const BankCoordinates around(truth, noise);
  for (const double far : {0.0, 5.0}) {
    const Eigen::VectorXd all = Eigen::VectorXd::Constant(around.size(), far);
    EXPECT_EQ(around.decode(all).R(0, 0), 0.01);
    EXPECT_NEAR(around.decode(all).R(1, 1), 0.01 + 0.01 * std::exp(far), 1e-12);
  }
}

/// By hand: the derivative of R_ii with respect to its logarithm is R_ii. The derivative of a row of T with respect to
/// the logarithm of one entry is T_ij (delta - T_ik).
TEST(BankCoordinates, JacobianIsThatOfTheParameters) {
  const Bank truth = test::true_scalar(1.0);
  const BankCoordinates around(truth, everything(truth, 0.1));
  const ParameterPlaces at = around.places();
  const Eigen::MatrixXd J = around.jacobian();
  ASSERT_EQ(J.rows(), 2 * 2 + 2 + 1 + 4);
  ASSERT_EQ(J.cols(), 2 * 2 + 2 + 1 + 2);
  EXPECT_NEAR(J(at.theta(1) + 1, 3), 0.1, 1e-11);
  EXPECT_NEAR(J(at.Q(1), 5), 2.0 * truth.modes[1].Q(0, 0), 1e-9);  // in these coordinates exp(z) multiplies the square
                                                                   // root of Q
  EXPECT_NEAR(J(at.R(), 6), truth.R(0, 0), 1e-9);
  const double T = truth.transition.matrix()(0, 1);
  EXPECT_NEAR(J(at.T(0) + 1, 7), T * (1.0 - T), 1e-9);
  EXPECT_NEAR(J(at.T(0), 7), -T * (1.0 - T), 1e-9);
}

class RefineRecovery : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RefineRecovery, TwoModesOfTwoStatesWithinThreeStandardErrors) {
  const Bank truth = test::true_pair(1.0);
  const Recording recording = simulated_recording(truth, 4, 600, GetParam());
  const Refinement refined = refine_blurred(truth, recording, 1);
  ASSERT_EQ(refined.bank.mode_count(), 2);
  EXPECT_EQ(refined.measurement.end, MeasuredFit::converged);
  ASSERT_EQ(refined.bank.R_standard_error.rows(), 2);
  for (const double z : test::z_values(refined.bank, truth)) EXPECT_LT(std::abs(z), 3.0);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RefineRecovery, testing::Values(11, 12, 13));

/// Regression test: the modes of the pendulum differ much. When the global residual covariance was the prior on Q, it
/// outweighed the data.
TEST(RefineRecovery, PendulumOfTwoDampingsIsCalibratedOnHeldOutRuns) {
  const Bank truth = test::true_pendulum({0.2, 20.0}, 1.0);
  const Recording recording = simulated_recording(truth, 4, 1500, 2);
  const Refinement refined = refine_blurred(truth, recording, 3);
  const Bank& bank = refined.bank;
  ASSERT_EQ(bank.mode_count(), 2);
  EXPECT_EQ(refined.measurement.end, MeasuredFit::converged);
  for (const double z : test::z_values(bank, truth)) EXPECT_LT(std::abs(z), 3.0);
  const DiagnosticsRow row = test::held_out_diagnostics(bank, truth, 2);
  const auto states = static_cast<double>(truth.structure.states);
  EXPECT_NEAR(row.nees_mean, states, 0.15 * states);
  // Switches are rare and large. So NIS is not chi-square, even if the model is correct.
  EXPECT_NEAR(row.nis_mean, test::held_out_diagnostics(truth, truth, 2).nis_mean, 0.05);
}

TEST(RefineRecovery, SaysThatTheLimitStoppedIt) {
  const Bank truth = test::true_pendulum({1.0}, 1.0);
  const Recording recording = simulated_recording(truth, 2, 800, 3);
  const Refinement stopped = refine_blurred(truth, recording, 1, 3);
  EXPECT_EQ(stopped.measurement.end, MeasuredFit::iteration_limit);
  EXPECT_LE(stopped.measurement.iterations, 3);
  EXPECT_EQ(refine_blurred(truth, recording, 1).measurement.end, MeasuredFit::converged);
}

}  // namespace
}  // namespace modebank
