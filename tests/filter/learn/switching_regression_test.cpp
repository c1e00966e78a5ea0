// The switching regression against the sum over all sequences of modes, the filter's likelihood, and its own laws.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/likelihood/maximum_likelihood.hpp"
#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Runs of n states and one input; the sequence of modes does not matter here.
Recording noisy_runs(Index n, const std::vector<Index>& samples, double missing = 0.0) {
  std::mt19937_64 generator(3);
  boost::random::normal_distribution<double> normal;
  Recording recording = test::empty_recording(n, 1);
  for (const Index count : samples) {
    Eigen::MatrixXd x = Eigen::MatrixXd::Zero(n, count), u(1, count);
    for (Index k = 0; k < count; ++k) {
      u(k) = normal(generator);
      const double gain = k / 7 % 2 == 0 ? 0.2 : 1.0, noise = k / 11 % 2 == 0 ? 0.1 : 0.5;
      for (Index i = 0; k + 1 < count && i < n; ++i)
        x(i, k + 1) = 0.7 * x(i, k) + gain * u(k) + noise * normal(generator);
    }
    if (missing > 0.0) x(0, count / 2) = std::numeric_limits<double>::quiet_NaN();
    test::add_run(recording, x, u);
  }
  return recording;
}

SwitchingRegression two_modes(const LinearStructure& s) {
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(s.states, s.states);
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(s.states, s.states);
  return {Eigen::VectorXd::Ones(s.parameters()) * Eigen::RowVector2d(-0.1, 0.2),
          {0.05 * identity + 0.02 * ones, 0.3 * identity - 0.05 * ones},
          Eigen::Matrix2d{{0.9, 0.1}, {0.3, 0.7}},
          Eigen::Vector2d(0.25, 0.75)};
}

double density(const Eigen::VectorXd& r, const Eigen::MatrixXd& Q) {
  return std::exp(-0.5 * r.dot(Q.inverse() * r)) / std::sqrt((2.0 * std::numbers::pi * Q).determinant());
}

/// p(run, modes before and at every transition), summed over all sequences of modes.
ModePosterior enumerate(const TrainingTransitions& t, const SwitchingRegression& model) {
  const Index K = model.modes();
  ModePosterior sum{Eigen::MatrixXd::Zero(t.count(), K), Eigen::MatrixXd::Zero(K, K), Eigen::VectorXd::Zero(K)};
  for (const RunRows& rows : t.runs) {
    double total = 0.0;
    ModePosterior of_run{Eigen::MatrixXd::Zero(rows.count, K), Eigen::MatrixXd::Zero(K, K), Eigen::VectorXd::Zero(K)};
    for (Index code = 0; code < Index{1} << (rows.count + 1); ++code) {
      const auto mode = [&](Index k) { return (code >> k) & 1; };  // k = 0 is the mode before the first transition
      double p = model.initial(mode(0));
      for (Index k = 0; k < rows.count; ++k) {
        const Index j = mode(k + 1);
        const Eigen::MatrixXd beta = coefficients(t.structure, model.theta.col(j));
        const Eigen::VectorXd r =
            (t.data.increments.row(rows.first + k) - t.data.regressors.row(rows.first + k) * beta).transpose();
        p *= model.transition(mode(k), j) * density(r, model.Q[j]);
      }
      total += p;
      of_run.first(mode(0)) += p;
      for (Index k = 0; k < rows.count; ++k) {
        of_run.probability(k, mode(k + 1)) += p;
        of_run.switches(mode(k), mode(k + 1)) += p;
      }
    }
    sum.log_likelihood += std::log(total);
    sum.first += of_run.first / total;
    sum.switches += of_run.switches / total;
    sum.probability.middleRows(rows.first, rows.count) = of_run.probability / total;
  }
  return sum;
}

TEST(SwitchingRegression, SmootherIsTheSumOverAllSequences) {
  for (const Index n : {1, 2}) {
    const Recording recording = noisy_runs(n, {7, 5});
    const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
    const SwitchingRegression model = two_modes(t.structure);
    const ModePosterior is = smooth_modes(t, model), expected = enumerate(t, model);
    EXPECT_NEAR(is.log_likelihood, expected.log_likelihood, 1e-11);
    EXPECT_TRUE(near(is.probability, expected.probability, 1e-12));
    EXPECT_TRUE(near(is.switches, expected.switches, 1e-11));
    EXPECT_TRUE(near(is.first, expected.first, 1e-12));
  }
}

TEST(SwitchingRegression, LikelihoodIsTheFiltersWithoutMeasurementNoise) {
  const Recording recording = noisy_runs(2, {200, 50});
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  const SwitchingRegression model = two_modes(t.structure);
  const Bank bank = with_modes(bank_frame(recording, t.structure, Eigen::MatrixXd::Zero(2, 2)), model);
  const double expected = training_log_likelihood(bank, recording, {});
  EXPECT_NEAR(smooth_modes(t, model).log_likelihood, expected, 1e-6);  // the filter has a lower bound on probabilities
}

TEST(SwitchingRegression, EveryIterationRaisesTheObjective) {
  const Recording recording = noisy_runs(2, {150, 90, 60}, 1.0);
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  for (const Index levels : {0, 1, 2}) {  // free modes; of one motion; of one motion whose Q differ by a factor
    SwitchingFit fit{two_modes(t.structure)};
    if (levels > 0) fit.model.theta.col(1) = fit.model.theta.col(0);
    if (levels > 0) fit.model.motion = {0, 0};
    if (levels > 1) fit.model.Q[1] = 3.0 * fit.model.Q[0];
    fit.model.noise_levels = std::max<Index>(levels, 1);
    iterate(t, switching_prior(t, fit_global(recording, t.structure), {}, 4.0), {}, 40, fit);
    const std::vector<double>& objective = fit.objective;
    for (std::size_t i = 1; i < objective.size(); ++i)
      EXPECT_GE(objective[i], objective[i - 1] - 1e-9 * std::abs(objective[i - 1])) << "iteration " << i;
    EXPECT_GT(objective.back(), objective.front() + 10.0);
    EXPECT_EQ(fit.model.theta.col(0) == fit.model.theta.col(1), levels > 0);
    const double factor = fit.model.Q[1](0, 0) / fit.model.Q[0](0, 0);
    EXPECT_EQ(test::near(fit.model.Q[1], factor * fit.model.Q[0], 1e-9), levels > 1);
  }
}

/// If T has zeros, the scale in the log domain must come from a possible mode.
TEST(SwitchingRegression, ImpossibleModesDoNotScaleTheOthersAway) {
  Recording recording = noisy_runs(1, {4});
  recording.runs[0].state << 0.0, 100.0, 100.0, 100.0;
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  SwitchingRegression model = two_modes(t.structure);
  model.theta.setZero();
  model.Q = {Eigen::MatrixXd::Ones(1, 1), Eigen::MatrixXd::Constant(1, 1, 1e4)};
  model.transition.setIdentity();
  model.initial = Eigen::Vector2d(1.0, 0.0);
  const ModePosterior posterior = smooth_modes(t, model);
  EXPECT_NEAR(posterior.log_likelihood, -0.5 * 1e4 - 1.5 * std::log(2.0 * std::numbers::pi), 1e-9);
  EXPECT_TRUE(near(posterior.probability.col(0), Eigen::VectorXd::Ones(3), 1e-15));
  EXPECT_TRUE(near(posterior.switches, Eigen::MatrixXd{{3.0, 0.0}, {0.0, 0.0}}, 1e-15));
  EXPECT_TRUE(near(posterior.first, Eigen::Vector2d(1.0, 0.0), 1e-15));
}

/// A covariance that is not definite has no density and no errors. theta is then not changed. One mode without a prior
/// is the global model.
TEST(SwitchingRegression, OneModeIsTheGlobalModelAndNotDefiniteNoiseIsSaidToBe) {
  const Recording recording = noisy_runs(2, {100, 80});
  const TrainingTransitions t = gather_training_transitions(recording, test::structure_of(recording));
  const GlobalModel global = fit_global(recording, t.structure);
  const SwitchingPrior prior = switching_prior(t, global, {}, 1.0);
  const Index p = t.structure.parameters();
  const SwitchingPrior none{Eigen::VectorXd::Zero(p), Eigen::MatrixXd::Zero(p, p), global.residual_covariance};
  SwitchingRegression model{
      global.theta, {global.residual_covariance}, Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Ones(1)};
  const ModePosterior posterior = smooth_modes(t, model);
  const auto errors = [&] {
    const Bank bank = with_modes(bank_frame(recording, t.structure, Eigen::MatrixXd::Zero(2, 2)), model);
    return with_complete_errors(t, posterior, prior, bank).modes[0].standard_error;
  };
  const SwitchingRegression best = maximise(t, posterior, none, {}, model);
  EXPECT_TRUE(near(best.theta, global.theta, 1e-10));
  EXPECT_TRUE(near(best.Q[0], global.residual_covariance, 1e-10));
  EXPECT_TRUE(std::isfinite(log_prior(prior, model)));
  EXPECT_TRUE(errors().allFinite());
  model.Q.front() *= -1.0;
  EXPECT_EQ(log_prior(prior, model), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(errors().array().isNaN().all());
  model.theta.setConstant(0.25);
  EXPECT_EQ(maximise(t, posterior, prior, {.alternations = 1}, model).theta, model.theta);
}

}  // namespace
}  // namespace modebank
