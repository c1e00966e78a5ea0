// Q and R of the baseline by maximum likelihood; the linear stage's model as a filter.
#include <gtest/gtest.h>

#include <cmath>

#include "modebank/base/error.hpp"
#include "tests/filter/learn/refine_recovery.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

Bank single_filter(double a, double q, double r) {
  Bank bank = test::single_mode(test::example_bank(1, 1, 1, r), 0);
  bank.structure.intercept = false;
  bank.modes[0].model.A(0, 0) = a;
  bank.modes[0].model.B(0, 0) = 0.5;
  bank.modes[0].Q(0, 0) = q;
  return bank;
}

GlobalModel model_of(const Recording& recording) { return fit_global(recording, test::structure_of(recording)); }

Baseline learn(const Recording& recording, const GlobalModel& global) {
  return learn_baseline(recording, global, test::structure_of(recording));
}

double likelihood_at(Bank bank, const Recording& recording, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  bank.modes[0].Q = Q;
  bank.R = R;
  double sum = 0.0;
  for (const Trajectory& run : recording.runs) sum += log_likelihood(bank, run, {FilterVariant::kf});
  return sum;
}

TEST(Baseline, NoGridPointIsMoreLikely) {
  for (const auto& [q, r] : {std::pair{0.04, 0.01}, std::pair{0.001, 0.05}, std::pair{0.04, 1e-5}}) {
    const Recording recording = test::simulated_recording(single_filter(-0.2, q, r), 2, 200, 1);
    const Baseline fit = learn(recording, model_of(recording));
    EXPECT_TRUE(fit.converged);
    // At the bound, a loss of 1e-7 per sample is allowed.
    const double slack = 1e-7 * static_cast<double>(recording.transitions(Role::train));
    const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
    for (int i = -24; i <= 4; ++i)
      for (int j = -24; j <= 4; ++j)
        EXPECT_GE(fit.log_likelihood + slack,
                  likelihood_at(fit.bank, recording, std::exp2(0.5 * i) * one, std::exp2(0.5 * j) * one))
            << "Q " << std::exp2(0.5 * i) << " R " << std::exp2(0.5 * j);
  }
}

TEST(Baseline, NoChangeOfTwoStatesNoiseIsMoreLikely) {
  Bank truth = test::single_mode(test::example_bank(2, 1, 1, 0.02), 0);
  truth.structure.intercept = false;
  truth.modes[0].Q << 0.08, 0.02, 0.02, 0.05;
  const Recording recording = test::simulated_recording(truth, 4, 500, 1);
  GlobalModel global = model_of(recording);
  global.theta = truth.theta(0);
  const Baseline fit = learn(recording, global);
  EXPECT_TRUE(fit.converged && !fit.at_bound);
  EXPECT_EQ(fit.bank.R(0, 1), 0.0);
  const Eigen::Matrix2d Q = fit.bank.modes[0].Q, R = fit.bank.R;
  EXPECT_TRUE(near(Q, truth.modes[0].Q, 0.02));
  for (const double change : {-1e-3, 1e-3})
    for (const auto& [i, j] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 1}}) {
      Eigen::Matrix2d other = Eigen::Matrix2d::Zero();
      other(i, j) = other(j, i) = change;
      EXPECT_GT(fit.log_likelihood, likelihood_at(fit.bank, recording, Q + other, R));
      if (i != j) continue;
      EXPECT_GT(fit.log_likelihood, likelihood_at(fit.bank, recording, Q, R + other));
    }
}

TEST(Baseline, WithoutMeasurementNoiseStopsAtTheBound) {
  const Recording recording = test::simulated_recording(single_filter(-0.3, 0.04, 1e-30), 3, 400, 1);
  const LinearStructure structure{1, 1, false, 2};
  // Measurement noise makes successive errors negatively correlated. If theta forgets too fast, the correlation is
  // positive.
  GlobalModel global = fit_global(recording, structure);
  global.theta.head(2) << -0.5, -0.1;
  const Baseline fit = learn_baseline(recording, global, structure);
  EXPECT_TRUE(fit.converged && fit.at_bound);
  EXPECT_TRUE(near(fit.bank.theta(0), global.theta, 0.0));
  EXPECT_TRUE(near(fit.bank.modes[0].standard_error, global.covariance.diagonal().cwiseSqrt(), 0.0));
  // An error of y enters the innovation of the same sample, and times 1 - 0.5 and -0.1 those of the next two.
  EXPECT_NEAR(fit.bank.R(0, 0), 1e-8 * global.residual_covariance(0, 0) / (1.0 + 0.25 + 0.01), 1e-20);
}

TEST(Baseline, OfDifferencesHasAPoleAtOneAndTheirAnswer) {
  Recording recording = test::simulated_recording(single_filter(-0.3, 0.04, 0.01), 1, 30, 1);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
  ArmaxFit fit{{{true, 1, 2, 1}, {3}}, Eigen::RowVector3d(0.9, 0.05, 0.01), -0.5 * one, one, {}, 1000};
  fit.covariance = Eigen::Matrix4d::Identity();
  const Bank bank = bank_of(recording, fit, {});
  const Eigen::Vector<double, 5> levels(0.9, -0.9, 0.05, -0.04, -0.01);  // less 1 for the increment
  EXPECT_TRUE(near(bank.theta(0), levels, 1e-15)) << "A steady input moves nothing";
  EXPECT_NEAR(bank.modes[0].standard_error(3), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(bank.modes[0].response.value.gain(0, 0), 0.6, 1e-9);
  recording.inputs.clear();
  fit = {{{true, 1, 0, 1}, {}}, 0.9 * one, -0.5 * one, one, Eigen::Matrix2d::Identity(), 1000};
  EXPECT_TRUE(near(bank_of(recording, fit, {}).theta(0), levels.head(2), 1e-15));
}

TEST(Baseline, ConstantDataEndFiniteAndNoDataAreAnError) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::MatrixXd::Zero(1, 30), Eigen::MatrixXd::Zero(1, 30));
  const GlobalModel global = model_of(recording);
  const Baseline fit = learn(recording, global);
  EXPECT_TRUE(fit.bank.modes[0].Q.allFinite() && fit.bank.R.allFinite() && std::isfinite(fit.log_likelihood));
  recording.runs.clear();
  EXPECT_THROW(learn(recording, global), DataError);
}

}  // namespace
}  // namespace modebank
