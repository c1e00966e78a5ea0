// With measurement noise refinement ends at the maximum of the filter's likelihood, and that recovers the truth.
#include "tests/filter/refine_recovery.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "filter/bank_coordinates.hpp"
#include "filter/learn.hpp"
#include "filter/likelihood_ascent.hpp"
#include "filter/refine_start.hpp"
#include "filter/training_likelihood.hpp"

namespace modebank {
namespace {

using test::refine_blurred;
using test::simulated_recording;

/// A prior that says nothing but that theta is the global model's, as the baseline has it.
SwitchingPrior theta_known(const Recording& recording, const LinearStructure& structure) {
  const TrainingTransitions transitions = gather_training_transitions(recording, structure);
  SwitchingPrior prior = switching_prior(transitions, fit_global(recording, structure), {}, 0.0);
  prior.information *= 1e12;
  prior.counts = 0.0;
  return prior;
}

/// One mode: the likelihood is exact, and the baseline maximises it over Q and R in its own way.
TEST(RaiseLikelihood, OfOneModeReachesTheBaselinesMaximum) {
  const Bank truth = test::true_pendulum({1.0}, 1.0);
  const Recording recording = simulated_recording(truth, 2, 800, 3);
  const Baseline baseline = learn_baseline(recording, fit_global(recording, truth.structure), truth.structure);
  ASSERT_TRUE(baseline.converged);
  Bank bank = baseline.bank;
  bank.modes[0].Q *= 4.0;
  bank.R *= 0.3;
  const LikelihoodTarget target{
      recording, {}, theta_known(recording, truth.structure), SharedParts::none, Eigen::VectorXd::Zero(2)};
  const Ascent ascent = raise_likelihood(target, {200, 1e-10}, bank);
  EXPECT_EQ(ascent.end, MeasuredFit::converged);
  EXPECT_NEAR(training_log_likelihood(bank, recording, {}), baseline.log_likelihood, 1e-4);
  constexpr double near_enough = 1e-2;  // a hundredth of each is far below its standard error
  EXPECT_TRUE(bank.modes[0].Q.isApprox(baseline.bank.modes[0].Q, near_enough)) << bank.modes[0].Q;
  EXPECT_NEAR(bank.modes[0].Q(0, 0), baseline.bank.modes[0].Q(0, 0), near_enough * bank.modes[0].Q(0, 0));
  EXPECT_NEAR(bank.R(0, 0), baseline.bank.R(0, 0), near_enough * bank.R(0, 0));
  EXPECT_NEAR(bank.R(1, 1), baseline.bank.R(1, 1), near_enough * bank.R(1, 1));
}

/// At a maximum no step to either side gains anything, whatever the number of modes.
TEST(RaiseLikelihood, EndsWhereNoStepGains) {
  const Bank truth = test::true_pair(1.0);
  const Recording recording = simulated_recording(truth, 3, 300, 5);
  Bank bank = truth;
  const TrainingTransitions transitions = gather_training_transitions(recording, truth.structure);
  const LikelihoodTarget target{recording,
                                {},
                                switching_prior(transitions, fit_global(recording, truth.structure), {}, 0.01),
                                SharedParts::none,
                                Eigen::VectorXd::Zero(2)};
  const double before = target.value(bank);
  const Ascent ascent = raise_likelihood(target, {}, bank);
  EXPECT_EQ(ascent.end, MeasuredFit::converged);
  EXPECT_EQ(ascent.value, target.value(bank));
  EXPECT_GT(ascent.value, before);
  const BankCoordinates around(bank, SharedParts::none, Eigen::MatrixXd::Constant(8, 2, 0.01), target.least_R);
  for (Index c = 0; c < around.size(); ++c)
    for (const double step : {-0.03, 0.03}) {
      const Eigen::VectorXd at = step * Eigen::VectorXd::Unit(around.size(), c);
      EXPECT_LT(target.value(around.decode(at)), ascent.value + 1e-3) << c << ", " << step;
    }
}

/// Only ratios of sample weights matter, and a sample of weight zero not at all.
TEST(RaiseLikelihood, CountsSamplesByTheirWeights) {
  const Bank truth = test::true_scalar(1.0);
  Recording recording = simulated_recording(truth, 2, 60, 7);
  const SwitchingPrior prior = theta_known(recording, truth.structure);
  const LikelihoodTarget target{recording, {}, prior, SharedParts::none, Eigen::VectorXd::Zero(1)};
  const double plain = target.value(truth);
  for (Trajectory& run : recording.runs) run.weight.setConstant(run.samples(), 3.0);
  EXPECT_NEAR(target.value(truth), plain, 1e-9 * std::abs(plain));
  const double last = log_densities(truth, recording.runs[1], {})(59);
  recording.runs[1].weight(59) = 0.0;
  EXPECT_NEAR(target.value(truth), plain - last, 1e-9 * std::abs(plain));
}

TEST(BankCoordinates, AreZeroAtTheirOriginAndMoveSharedPartsTogether) {
  const Bank truth = test::true_pair(1.0);
  const Eigen::MatrixXd units = Eigen::MatrixXd::Constant(8, 2, 0.1);
  const BankCoordinates free(truth, SharedParts::none, units, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(free.size(), 2 * 8 + 2 * 3 + 2 + 2);
  const Bank same = free.decode(Eigen::VectorXd::Zero(free.size()));
  for (std::size_t j = 0; j < 2; ++j) {
    EXPECT_TRUE(same.modes[j].Q.isApprox(truth.modes[j].Q, 1e-14));
    EXPECT_EQ(same.theta(static_cast<Index>(j)), truth.theta(static_cast<Index>(j)));
  }
  EXPECT_TRUE(same.R.isApprox(truth.R, 1e-14));
  EXPECT_TRUE(same.transition.matrix().isApprox(truth.transition.matrix(), 1e-14));

  const BankCoordinates one_noise(truth, SharedParts::noise, units, {});
  EXPECT_EQ(one_noise.size(), 2 * 8 + 3 + 2);
  const Bank louder = one_noise.decode(0.5 * Eigen::VectorXd::Unit(one_noise.size(), 16));
  EXPECT_NEAR(louder.modes[0].Q(0, 0), std::exp(1.0) * truth.modes[0].Q(0, 0), 1e-12);
  EXPECT_NEAR(louder.modes[1].Q(0, 0), std::exp(1.0) * truth.modes[1].Q(0, 0), 1e-12);
  EXPECT_EQ(louder.R, truth.R);
  const BankCoordinates one_theta(truth, SharedParts::theta, units, {});
  EXPECT_EQ(one_theta.size(), 8 + 2 * 3 + 2);
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

/// The pendulum whose modes differ so much that the global residual covariance, as a prior on Q, outweighed the data.
TEST(RefineRecovery, PendulumOfTwoDampingsIsCalibratedOnHeldOutRuns) {
  const Bank truth = test::true_pendulum({0.2, 20.0}, 1.0);
  const Recording recording = simulated_recording(truth, 4, 1500, 2);
  const Refinement refined = refine_blurred(truth, recording, 3);
  const Bank& bank = refined.bank;
  ASSERT_EQ(bank.mode_count(), 2);
  EXPECT_EQ(refined.measurement.end, MeasuredFit::converged);
  for (const double z : test::z_values(bank, truth)) EXPECT_LT(std::abs(z), 3.0);
  const DiagnosticsRow row = test::held_out_diagnostics(bank, truth, 2);
  EXPECT_GT(row.nees_mean, row.nees_lower);
  EXPECT_LT(row.nees_mean, row.nees_upper);
  // Switches are rare and far: their NIS is not chi-square's, of a true filter neither.
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
