// Q and R of the baseline by maximum likelihood.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "filter/learn/chain/stages.hpp"
#include "modebank/base/error.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
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

Recording simulated(const Bank& bank, Index runs, Index samples, std::uint64_t seed = 100) {
  Recording recording = test::empty_recording(bank.structure.states, bank.structure.inputs);
  for (Index i = 0; i < runs; ++i) {
    const Trajectory run = test::simulate_bank(bank, samples, seed + static_cast<std::uint64_t>(i));
    test::add_run(recording, run.state, run.input);
  }
  return recording;
}

/// theta is fixed at the true value; this test concerns Q and R.
GlobalModel model_at(const Recording& recording, const Bank& truth) {
  GlobalModel global = fit_global(recording, test::structure_of(recording));
  global.theta = truth.theta(0);
  return global;
}

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

/// Q's lower triangle and R's diagonal in one vector.
Eigen::VectorXd noise_vector(const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R) {
  std::vector<double> values;
  for (Index j = 0; j < Q.cols(); ++j)
    for (Index i = j; i < Q.rows(); ++i) values.push_back(Q(i, j));
  for (const double r : R.diagonal()) values.push_back(r);
  return Eigen::VectorXd::Map(values.data(), std::ssize(values));
}

double likelihood_at(const Bank& bank, const Recording& recording, const Eigen::VectorXd& noise) {
  const Index n = bank.structure.states;
  Eigen::MatrixXd Q(n, n);
  Index next = 0;
  for (Index j = 0; j < n; ++j)
    for (Index i = j; i < n; ++i) Q(i, j) = Q(j, i) = noise(next++);
  return likelihood_at(bank, recording, Q, noise.tail(n).asDiagonal());
}

/// Standard errors from the curvature of the log-likelihood at the estimate, by central differences.
Eigen::VectorXd noise_standard_errors(const Baseline& fit, const Recording& recording) {
  const Eigen::VectorXd at = noise_vector(fit.bank.modes[0].Q, fit.bank.R);
  const Index d = at.size();
  const Eigen::MatrixXd steps = 1e-2 * at.minCoeff() * Eigen::MatrixXd::Identity(d, d);
  Eigen::MatrixXd information(d, d);
  const auto value = [&](const Eigen::VectorXd& move) { return likelihood_at(fit.bank, recording, at + move); };
  for (Index i = 0; i < d; ++i)
    for (Index j = 0; j < d; ++j) {
      const Eigen::VectorXd a = steps.col(i), b = steps.col(j);
      information(i, j) =
          -(value(a + b) - value(a - b) - value(b - a) + value(-a - b)) / (4 * steps(i, i) * steps(j, j));
    }
  return information.inverse().diagonal().cwiseSqrt();
}

/// (estimate - true value) / standard error, for every entry of noise_vector.
Eigen::VectorXd standardised_errors(const Baseline& fit, const Recording& recording, const Bank& truth) {
  const Eigen::VectorXd expected = noise_vector(truth.modes[0].Q, truth.R);
  const Eigen::VectorXd error = noise_standard_errors(fit, recording);
  EXPECT_LT(error.cwiseQuotient(expected).maxCoeff(), 0.3) << "the data must be telling";
  return (noise_vector(fit.bank.modes[0].Q, fit.bank.R) - expected).cwiseQuotient(error);
}

TEST(Baseline, ErrorsOfQAndRAreAsLargeAsTheirStandardErrors) {
  constexpr int repetitions = 20;
  const Bank truth = single_filter(-0.3, 0.04, 0.01);
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (int i = 0; i < repetitions; ++i) {
    const Recording recording = simulated(truth, 2, 500, 1000 + 10 * static_cast<std::uint64_t>(i));
    const Baseline fit = learn(recording, model_at(recording, truth));
    EXPECT_TRUE(fit.converged && !fit.at_bound) << "repetition " << i;
    squares += standardised_errors(fit, recording, truth).cwiseAbs2();
  }
  // 0.1 % and 99.9 % quantiles of chi-square(20).
  EXPECT_GT(squares.minCoeff(), 5.92);
  EXPECT_LT(squares.maxCoeff(), 45.31);
}

TEST(Baseline, NoGridPointIsMoreLikely) {
  for (const auto& [q, r] : {std::pair{0.04, 0.01}, std::pair{0.001, 0.05}, std::pair{0.04, 1e-5}}) {
    const Bank truth = single_filter(-0.2, q, r);
    const Recording recording = simulated(truth, 2, 200);
    const Baseline fit = learn(recording, fit_global(recording, test::structure_of(recording)));
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

TEST(Baseline, WithoutMeasurementNoiseStopsAtTheBound) {
  const Bank truth = single_filter(-0.3, 0.04, 1e-30);
  const Recording recording = simulated(truth, 3, 400);
  // Measurement noise makes successive errors negatively correlated. If theta forgets too fast, the correlation is
  // positive.
  GlobalModel global = fit_global(recording, test::structure_of(recording));
  global.theta(0) = -0.5;
  const Baseline fit = learn(recording, global);
  EXPECT_TRUE(fit.converged);
  EXPECT_TRUE(fit.at_bound);
  EXPECT_TRUE(near(fit.bank.theta(0), global.theta, 0.0));
  EXPECT_TRUE(near(fit.bank.modes[0].standard_error, global.covariance.diagonal().cwiseSqrt(), 0.0));
  // An error of y enters the innovation of the same sample. Times 1 - 0.5, it also enters the innovation of the next
  // sample.
  EXPECT_NEAR(fit.bank.R(0, 0), 1e-8 * global.residual_covariance(0, 0) / (1.0 + 0.25), 1e-20);
}

/// Exact data of six lags, with poles at 0.95. The variance of the residuals is 1e-11 times the variance of the data,
/// and the squares of the coefficients sum to about 600. R must be able to become negligible compared with the
/// residuals.
TEST(Baseline, TheBoundOfRCostsNothingInDataOfManyLags) {
  const LinearStructure structure{1, 1, false, 6};
  Recording recording = test::empty_recording(1, 1);
  std::mt19937_64 generator(5);
  boost::random::normal_distribution<double> normal;
  for (int run = 0; run < 3; ++run) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, 400), u(1, 400);
    for (Index k = 0; k < 400; ++k) u(k) = normal(generator);
    const std::array<double, 6> binomial{6, -15, 20, -15, 6, -1};
    for (Index k = 6; k < 400; ++k) {
      x(k) = 0.2 * u(k - 1) + 0.1 * normal(generator);
      for (Index lag = 1; lag <= 6; ++lag)
        x(k) += binomial[static_cast<std::size_t>(lag - 1)] * std::pow(0.95, lag) * x(k - lag);
    }
    test::add_run(recording, x, u);
  }
  const GlobalModel global = fit_global(recording, structure);
  const Baseline fit = learn_baseline(recording, global, structure);
  EXPECT_TRUE(fit.converged);
  Bank without = fit.bank;
  without.R *= 1e-3;
  without.modes[0].Q(0, 0) = global.residual_covariance(0, 0);
  double expected = 0.0;
  for (const Trajectory& run : recording.runs) expected += log_likelihood(without, run, {FilterVariant::kf});
  EXPECT_GT(fit.log_likelihood, expected - 1e-4 * static_cast<double>(recording.transitions(Role::train)));
}

TEST(Baseline, RecoversTwoStates) {
  Bank truth = test::single_mode(test::example_bank(2, 1, 1, 0.02), 0);
  truth.structure.intercept = false;
  truth.modes[0].Q << 0.08, 0.02, 0.02, 0.05;
  const Recording recording = simulated(truth, 4, 500);
  const Baseline fit = learn(recording, model_at(recording, truth));
  EXPECT_TRUE(fit.converged);
  EXPECT_EQ(fit.bank.R(0, 1), 0.0);
  EXPECT_GE(fit.log_likelihood, likelihood_at(fit.bank, recording, truth.modes[0].Q, truth.R));
  EXPECT_LT(standardised_errors(fit, recording, truth).cwiseAbs().maxCoeff(), 3.0);
}

TEST(Baseline, OfDifferencesHasAPoleAtOneAndTheirAnswer) {
  Recording recording = simulated(single_filter(-0.3, 0.04, 0.01), 1, 30);
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

TEST(Baseline, ConstantDataEndFinite) {
  Recording recording = test::empty_recording(1, 1);
  test::add_run(recording, Eigen::MatrixXd::Zero(1, 30), Eigen::MatrixXd::Zero(1, 30));
  const Baseline fit = learn(recording, fit_global(recording, test::structure_of(recording)));
  EXPECT_TRUE(fit.bank.modes[0].Q.allFinite() && fit.bank.R.allFinite());
  EXPECT_TRUE(std::isfinite(fit.log_likelihood));
}

TEST(Baseline, WithoutTrainingRunsIsAnError) {
  const Recording recording = test::empty_recording(1, 1);
  GlobalModel global;
  global.theta = Eigen::Vector2d::Zero();
  global.covariance.setZero(2, 2);
  global.residual_covariance.setOnes(1, 1);
  EXPECT_THROW(learn(recording, global), DataError);
}

}  // namespace
}  // namespace modebank
