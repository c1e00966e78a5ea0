// Laws of weighted regressions. chain_test.py computes those of a bank again.
#include "filter/learn/from_mixture/pooled_modes.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/filter/learn/learn_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Closed forms for well-conditioned data (condition number below 1e2).
constexpr double exact = 1e-10;
/// theta and Q alternate until theta changes little.
constexpr double minimiser = 2e-6;

/// Two runs of 105 samples in all, with weights between 0 and 1.
struct WeightedData {
  Recording recording = test::empty_recording(2, 1);
  LinearStructure structure;
  TrainingTransitions transitions;
  GlobalModel global;
  Eigen::VectorXd weights;

  WeightedData() {
    std::mt19937_64 generator(11);
    boost::random::normal_distribution<double> normal;
    for (const Index samples : {60, 45}) {
      Eigen::MatrixXd x = Eigen::MatrixXd::Zero(2, samples), u(1, samples);
      for (Index k = 0; k < samples; ++k) {
        u(0, k) = normal(generator);
        if (k + 1 == samples) break;
        x(0, k + 1) = 0.7 * x(0, k) + 0.1 * x(1, k) + 0.4 * u(0, k) + 0.1 * normal(generator);
        x(1, k + 1) = 0.05 * x(0, k) + 0.5 * x(1, k) - 0.2 * u(0, k) + 0.1 * normal(generator);
      }
      test::add_run(recording, x, u);
    }
    structure = test::structure_of(recording);
    transitions = gather_training_transitions(recording, structure);
    global = fit_global(recording, structure);
    weights = Eigen::VectorXd::NullaryExpr(transitions.count(), [&] { return std::abs(std::sin(normal(generator))); });
  }
};

TEST(WeightedMode, OfManyTransitionsIsTheSame) {
  WeightedData data;
  const ModeEstimate expected = fit_weighted_mode(data.transitions, data.weights, data.global, nullptr);
  EXPECT_NEAR(expected.effective_transitions, data.weights.sum(), exact);
  Transitions& rows = data.transitions.data;
  const Index copies = 600'000 / rows.count();  // several blocks; the last one is not full
  rows.regressors = rows.regressors.replicate(copies, 1).eval();
  rows.increments = rows.increments.replicate(copies, 1).eval();
  const Eigen::VectorXd weights = data.weights.replicate(copies, 1) / static_cast<double>(copies);
  const ModeEstimate mode = fit_weighted_mode(data.transitions, weights, data.global, nullptr);
  EXPECT_TRUE(near(mode.theta, expected.theta, exact));
  EXPECT_TRUE(near(mode.Q, expected.Q, exact));
  EXPECT_TRUE(near(mode.standard_error, expected.standard_error, exact));
}

TEST(WeightedMode, PriorMaximisesThePenalisedLikelihood) {
  const WeightedData data;
  const ParameterPrior prior{data.global.theta, Eigen::VectorXd::LinSpaced(6, 0.02, 0.2)};
  const ModeEstimate mode = fit_weighted_mode(data.transitions, data.weights, data.global, &prior);
  const Transitions& rows = data.transitions.data;
  const Eigen::MatrixXd r = rows.increments - rows.regressors * coefficients(data.structure, mode.theta);
  const Eigen::MatrixXd weighted = data.weights.asDiagonal() * r;
  EXPECT_TRUE(near(mode.Q, r.transpose() * weighted / data.weights.sum(), minimiser));
  const Eigen::MatrixXd slope = rows.regressors.transpose() * weighted * mode.Q.inverse();
  const Eigen::VectorXd pull = (mode.theta - data.global.theta).array() / prior.sd.array().square();
  EXPECT_TRUE(near(slope.reshaped(), pull, 1e-7 * pull.norm())) << "the gradient is zero";
}

TEST(WeightedMode, WithoutWeightStaysAtTheGlobalModel) {
  const WeightedData data;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(data.transitions.count());
  const Eigen::VectorXd sd = Eigen::VectorXd::Constant(6, 0.3);
  const ParameterPrior prior{data.global.theta, sd};
  const ModeEstimate mode = fit_weighted_mode(data.transitions, none, data.global, &prior);
  EXPECT_TRUE(near(mode.theta, data.global.theta, exact));
  EXPECT_TRUE(near(mode.Q, data.global.residual_covariance, exact));
  EXPECT_TRUE(near(mode.standard_error, sd, exact)) << "the prior is all that is known";
  const ModeEstimate unknown = fit_weighted_mode(data.transitions, none, data.global, nullptr);
  EXPECT_TRUE(near(unknown.theta, data.global.theta, exact));
  EXPECT_TRUE(unknown.standard_error.array().isNaN().all());
}

TEST(WeightedMode, UnexcitedDirectionsStayAtTheGlobalModel) {
  // Inputs that differ only in the first half. A mode of the second half determines only the sum of their gains.
  std::mt19937_64 generator(4);
  boost::random::normal_distribution<double> normal;
  const Index N = 121;
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(1, N), u(2, N);
  for (Index k = 0; k < N; ++k) {
    u(0, k) = normal(generator);
    u(1, k) = k < 60 ? normal(generator) : u(0, k);
    if (k + 1 < N) x(k + 1) = 0.6 * x(k) + 0.5 * u(0, k) - 0.2 * u(1, k) + 0.1 * normal(generator);
  }
  Recording recording = test::empty_recording(1, 2);
  test::add_run(recording, x, u);
  const LinearStructure structure = test::structure_of(recording);
  const GlobalModel global = fit_global(recording, structure);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(N - 1);
  weights.tail(60).setOnes();
  const TrainingTransitions transitions = gather_training_transitions(recording, structure);
  const ModeEstimate mode = fit_weighted_mode(transitions, weights, global, nullptr);
  EXPECT_NEAR(mode.theta(1) - mode.theta(2), global.theta(1) - global.theta(2), exact);
  EXPECT_GT(std::abs(mode.theta(1) + mode.theta(2) - global.theta(1) - global.theta(2)), 1e-4);
  EXPECT_TRUE(mode.standard_error.array().isNaN().all());
}

TEST(WeightedMode, NoiseIsFlooredWhereAModeFitsExactly) {
  const WeightedData data;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(data.transitions.count());
  weights.head(3).setOnes();  // as many transitions as regressors
  const ModeEstimate mode = fit_weighted_mode(data.transitions, weights, data.global, nullptr);
  const Eigen::MatrixXd floor = process_noise_floor * data.global.noise_variance().asDiagonal().toDenseMatrix();
  EXPECT_TRUE(near(mode.Q, floor, 1e-6 * floor.maxCoeff()));
}

}  // namespace
}  // namespace modebank
