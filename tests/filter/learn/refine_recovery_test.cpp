// With measurement noise, refinement ends at the maximum of the filter's likelihood, which recovers the parameters.
#include "tests/filter/learn/refine_recovery.hpp"

#include <gtest/gtest.h>

#include "filter/learn/likelihood/maximum_likelihood.hpp"

namespace modebank {
namespace {

using test::refine_blurred;
using test::simulated_recording;

FreeParameters everything(Bank bank, double theta_unit) {
  for (Mode& mode : bank.modes) mode.standard_error.setConstant(bank.structure.parameters(), theta_unit);
  return all_parameters(bank, true, Eigen::VectorXd::Zero(bank.R.rows()));
}

/// At a maximum no step in either direction gains.
TEST(MaximiseLikelihood, EndsWhereNoStepGains) {
  const Bank truth = test::true_pair(1.0);
  const Recording recording = simulated_recording(truth, 3, 300, 5);
  const TrainingTransitions rows = gather_training_transitions(recording, truth.structure);
  const LikelihoodTarget target{recording, {}, switching_prior(rows, fit_global(recording, truth.structure), {}, 0.01)};
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

/// A starting value of R may be below R's bound for some outputs. Variances must not become negative.
TEST(BankCoordinates, KeepRAtItsBound) {
  Bank truth = test::true_pair(1.0);
  truth.R.diagonal() << 0.005, 0.02;
  const BankCoordinates around(truth, {.R = {0, 1}, .least_R = Eigen::Vector2d(0.01, 0.01), .transition = false});
  for (const double far : {0.0, 5.0}) {
    const Eigen::MatrixXd R = around.decode(Eigen::VectorXd::Constant(around.size(), far)).R;
    EXPECT_EQ(R(0, 0), 0.01);
    EXPECT_NEAR(R(1, 1), 0.01 + 0.01 * std::exp(far), 1e-12);
  }
}

/// By hand: the derivative of R_ii by its logarithm is R_ii; that of a row of T by the logarithm of one entry is T_ij
/// (delta - T_ik).
TEST(BankCoordinates, JacobianIsThatOfTheParameters) {
  const Bank truth = test::true_scalar(1.0);
  const BankCoordinates around(truth, everything(truth, 0.1));
  const Eigen::MatrixXd J = around.jacobian();
  ASSERT_EQ(J.rows(), 2 * 2 + 2 + 1 + 4);
  ASSERT_EQ(J.cols(), 2 * 2 + 2 + 1 + 2);
  const Index second = 2 + 1 + 2;  // first parameter of the second mode: theta, Q and the row of T come before it
  EXPECT_NEAR(J(second + 1, 3), 0.1, 1e-11);
  EXPECT_NEAR(J(second + 2, 5), 2.0 * truth.modes[1].Q(0, 0), 1e-9);  // exp(z) multiplies the square root of Q
  EXPECT_NEAR(J(2 * second, 6), truth.R(0, 0), 1e-9);
  const double T = truth.transition.matrix()(0, 1);
  EXPECT_NEAR(J(4, 7), T * (1.0 - T), 1e-9);
  EXPECT_NEAR(J(3, 7), -T * (1.0 - T), 1e-9);
}

TEST(RefineRecovery, TwoModesOfTwoStatesWithinThreeStandardErrors) {
  const Bank truth = test::true_pair(1.0);
  for (const std::uint64_t seed : {11, 12, 13}) {
    const Refinement refined = refine_blurred(truth, simulated_recording(truth, 4, 600, seed), 1);
    ASSERT_EQ(refined.bank.mode_count(), 2);
    EXPECT_EQ(refined.measurement.end, MeasuredFit::converged);
    for (const double z : test::z_values(refined.bank, truth)) EXPECT_LT(std::abs(z), 3.0) << seed;
  }
}

/// Regression test: the modes differ much, and the global residual covariance as prior on Q outweighed the data.
TEST(RefineRecovery, PendulumOfTwoDampingsIsCalibratedOnHeldOutRuns) {
  const Bank truth = test::true_pendulum({0.2, 20.0}, 1.0);
  const Refinement refined = refine_blurred(truth, simulated_recording(truth, 4, 1500, 2), 3);
  ASSERT_EQ(refined.bank.mode_count(), 2);
  EXPECT_EQ(refined.measurement.end, MeasuredFit::converged);
  for (const double z : test::z_values(refined.bank, truth)) EXPECT_LT(std::abs(z), 3.0);
  const DiagnosticsRow row = test::held_out_diagnostics(refined.bank, truth, 2);
  EXPECT_NEAR(row.nees_mean, 2.0, 0.15 * 2.0);
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
