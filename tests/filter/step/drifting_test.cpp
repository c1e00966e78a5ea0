// Steps of the drifting model: closed forms, missing samples, starts.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <stdexcept>
#include <vector>

#include "filter/judge/horizon.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/bank_filter.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/distributions.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_drifting;
using test::fixed;
using test::holed;
using test::near;
using test::simulate_drifting;

constexpr double drift_digits = 1e-10;  // tolerance for two computations in double precision over a few hundred samples

TEST(StudentNoise, DensityIsTheSlopeOfTheProbabilityAndHasVarianceOne) {
  for (const double nu : {0.0, 2.5, 3.0, 8.0, 15.0}) {
    const StudentNoise noise(nu);
    for (const double x : {-4.0, -0.3, 0.0, 1.0, 7.0}) {
      const double h = 1e-4, slope = (noise.probability(x + h) - noise.probability(x - h)) / (2 * h);
      EXPECT_NEAR(std::exp(noise.log_density(x * x)), slope, 1e-7) << nu << " at " << x;
    }
    if (nu == 2.5) continue;  // the tails of the distribution are too long for numerical integration
    const double variance =
        integrate([&](double x) { return 2.0 * x * x * std::exp(noise.log_density(x * x)); }, 0.0, 2e4);
    EXPECT_NEAR(variance, 1.0, nu == 3.0 ? 1e-3 : 1e-6) << nu;
  }
  for (const double nu : {-1.0, 1.0, 2.0, double{INFINITY}, std::nan("")})
    EXPECT_THROW(StudentNoise{nu}, std::invalid_argument);
}

/// One factor on the input's coefficient, with known noise: x[k+1] = (1 + a) x[k] + g[k] b u[k] + e, where g is a
/// random walk. The Kalman filter of (a, b g) is written out.
TEST(Drifting, OneFactorWandersAlongTheInputsCoefficients) {
  Bank model = example_drifting(1, 2, 1);
  model.drift.wandering = Wandering::gain;
  model.drift.rates = {0.01, 0.1, 1.0};
  const Trajectory run = simulate_drifting(model, 60, 3);
  const Eigen::MatrixXd d = DriftingModel(model).direction;
  ASSERT_EQ(d.rows(), 4);
  EXPECT_NEAR(d.norm(), 1.0, drift_digits);
  EXPECT_EQ(d(0, 0), 0.0);  // coefficient of the state
  EXPECT_EQ(d(3, 0), 0.0);  // the constant
  EXPECT_NEAR(d(1, 0) / d(2, 0), model.theta(0)(1) * model.drift.scale(1) / (model.theta(0)(2) * model.drift.scale(2)),
              drift_digits);
  Eigen::VectorXd theta = model.drift.scale.asDiagonal() * model.theta(0);
  Eigen::MatrixXd P = 0.1 * Eigen::MatrixXd::Identity(4, 4);
  DriftingFilter filter(model);
  filter.start(run.state.col(0));
  for (Index k = 0; k + 1 < run.samples(); ++k) {
    if (k > 0) P += 0.01 * d * d.transpose();
    Eigen::VectorXd h(4);
    h << run.state(0, k), run.input.col(k), 1.0;
    h.array() /= model.drift.scale.array();
    const double predicted = run.state(0, k) + theta.dot(h), growth = 1.0 + h.dot(P * h);
    filter.predict(run.input.col(k));
    EXPECT_NEAR(filter.growth(0), growth, drift_digits);
    const Eigen::VectorXd gain = P * h / growth;
    theta += gain * (run.state(0, k + 1) - predicted);
    P -= (gain * h.transpose() * P).eval();
    filter.update(run.state.col(k + 1));
    EXPECT_NEAR(filter.innovation()(0), run.state(0, k + 1) - predicted, drift_digits);
  }
  model.structure.intercept = false;
  model.drift.wandering = Wandering::constant;
  EXPECT_THROW(validate(model), std::invalid_argument);
}

TEST(Drifting, FixedCoefficientsAndVarianceAreOneKalmanFilter) {
  for (const Index n : {1, 2})
    for (const Index lags : {1, 3}) {
      Bank model = example_drifting(n, 2, lags);
      model.drift.rates = {0.0, 0.0, 1.0};
      model.running_noise.lam = 1.0;
      model.running_noise.nu = 0.0;
      const Trajectory run = simulate_drifting(model, 200, 3);
      const RunEvaluation drifting = evaluate_run(model, run, {});
      const RunEvaluation bank = evaluate_run(fixed(model), run, {FilterVariant::kf});
      EXPECT_TRUE(near(drifting.prediction, bank.prediction, drift_digits));
      EXPECT_TRUE(near(drifting.innovation, bank.innovation, drift_digits));
      EXPECT_TRUE(near(drifting.innovation_covariance, bank.innovation_covariance, drift_digits));
      EXPECT_TRUE(near(drifting.state, bank.state, drift_digits));
      EXPECT_TRUE(near(drifting.log_density, bank.log_density, 1e3 * drift_digits));
      EXPECT_TRUE(near(drifting.pit, bank.pit, 1e3 * drift_digits));
      EXPECT_TRUE(near(drifting.nis, bank.nis, 1e3 * drift_digits));
      EXPECT_TRUE(near(drifting.mode_probability, bank.mode_probability, 0.0));
    }
}

/// q = 0: theta is the regularised least squares estimate from all samples so far, for any noise variances.
TEST(Drifting, ConstantCoefficientsAreBatchLeastSquares) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Bank model = example_drifting(2, 1, 2);
    const Trajectory run = simulate_drifting(model, 40 + static_cast<Index>(seed), seed);
    model.drift.rates = {0.0, seed % 2 == 0 ? 0.5 : 1e4, 1.0};
    DriftingFilter filter(model);
    const RunInstants instants(model, run);
    for (Index t = 0; t < instants.count(); ++t) follow(instants, t, run, filter);
    const Index r = model.structure.regressors(), first = model.structure.first_transition();
    Eigen::MatrixXd G = Eigen::MatrixXd::Identity(r, r) / model.drift.rates.p0;
    Eigen::MatrixXd b = DriftingModel(model).theta0 / model.drift.rates.p0;
    Eigen::VectorXd h(r);
    for (Index k = first; k < run.transitions(); ++k) {
      h << run.state.col(k), run.state.col(k - 1), run.input.col(k), run.input.col(k - 1), 1.0;
      h = h.cwiseQuotient(model.drift.scale).eval();
      G += h * h.transpose();
      b += h * (run.state.col(k + 1) - run.state.col(k)).transpose();
    }
    EXPECT_TRUE(near(filter.theta(), G.ldlt().solve(b), 1e-7)) << seed;
    const Eigen::MatrixXd P = filter.P(0, 0).selfadjointView<Eigen::Lower>();
    EXPECT_TRUE(near(P, G.inverse(), 1e-7)) << seed;
  }
}

TEST(Drifting, ScoresTheSamplesThatABankScores) {
  for (const Index n : {1, 2})
    for (const Index lags : {1, 3}) {
      Bank model = example_drifting(n, 1, lags);
      model.dt_s = 1.0;
      const Trajectory run = holed(simulate_drifting(model, 140, 5));
      const RunEvaluation drifting = evaluate_run(model, run, {});
      const RunEvaluation bank = evaluate_run(fixed(model), run, {FilterVariant::kf});
      const auto nan = [](const Eigen::MatrixXd& x) { return Eigen::MatrixXd(x.array().isNaN().cast<double>()); };
      EXPECT_EQ(nan(drifting.log_density), nan(bank.log_density));
      EXPECT_EQ(nan(drifting.innovation), nan(bank.innovation));
      EXPECT_EQ(nan(drifting.pit), nan(bank.pit));
      EXPECT_EQ(nan(drifting.prediction), nan(bank.prediction));
      EXPECT_EQ(nan(drifting.state), nan(bank.state));
      EXPECT_EQ(nan(drifting.nis), nan(bank.nis));
      const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {5, 1, 2}),
                              of_bank = evaluate_horizons(fixed(model), run, {FilterVariant::kf}, {5, 1, 2});
      EXPECT_EQ(ahead.horizons, of_bank.horizons);
      EXPECT_EQ(nan(ahead.log_density), nan(of_bank.log_density));
      for (std::size_t h = 0; h < 3; ++h) EXPECT_EQ(nan(ahead.error[h]), nan(of_bank.error[h]));
    }
}

/// The published recursion for one output with given regressors. NaN means a missing sample.
struct Printed {
  Eigen::VectorXd log_density, prediction;
};
Printed printed(const Bank& m, Index output, const Eigen::MatrixXd& h, const Eigen::VectorXd& increments) {
  const Eigen::VectorXd theta0 = DriftingModel(m).theta0.col(output);
  Eigen::VectorXd theta = theta0;
  Eigen::MatrixXd P = m.drift.rates.p0 * Eigen::MatrixXd::Identity(h.rows(), h.rows());
  double v = m.noise_variance()(output);
  Printed out{Eigen::VectorXd(h.cols()), Eigen::VectorXd(h.cols())};
  for (Index k = 0; k < h.cols(); ++k) {
    if (k > 0) {
      theta = theta0 + m.drift.rates.leak * (theta - theta0);
      P = m.drift.rates.leak * m.drift.rates.leak * P + m.drift.rates.q * Eigen::MatrixXd::Identity(h.rows(), h.rows());
    }
    const double growth = 1.0 + h.col(k).dot(P * h.col(k)), e = increments(k) - theta.dot(h.col(k));
    out.prediction(k) = theta.dot(h.col(k));
    const StudentNoise noise(m.running_noise.nu);
    out.log_density(k) = noise.log_density(e * e / (v * growth)) - 0.5 * std::log(v * growth);
    if (std::isnan(e)) continue;
    theta += P * h.col(k) * (e / growth);
    P -= P * h.col(k) * h.col(k).transpose() * P / growth;
    v = std::max(m.running_noise.lam * v + (1.0 - m.running_noise.lam) * e * e / growth, m.running_noise.floor(output));
  }
  return out;
}

/// Outputs may share P only as long as sharing does not change the result.
TEST(Drifting, EveryOutputLearnsFromItsOwnSamples) {
  for (const double nu : {0.0, 5.0}) {
    Bank model = example_drifting(3, 1, 1);
    model.running_noise.nu = nu;
    Trajectory run = simulate_drifting(model, 80, 11);
    run.state(1, 20) = run.state(1, 21) = run.state(2, 21) = run.state(0, 50) = std::nan("");
    run.state.col(60).setConstant(std::nan(""));
    const RunEvaluation result = evaluate_run(model, run, {});
    Eigen::MatrixXd h(model.structure.regressors(), run.transitions());
    for (Index k = 0; k < run.transitions(); ++k) {
      h.col(k) << result.state.col(k), run.input.col(k), 1.0;
      h.col(k) = h.col(k).cwiseQuotient(model.drift.scale).eval();
    }
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(run.transitions());
    for (Index i = 0; i < 3; ++i) {
      const Eigen::VectorXd before = result.state.row(i).head(run.transitions());
      const Printed expected = printed(model, i, h, run.state.row(i).tail(run.transitions()).transpose() - before);
      EXPECT_TRUE(near(result.prediction.row(i).tail(run.transitions()).transpose(), before + expected.prediction,
                       drift_digits));
      sum += expected.log_density.unaryExpr([](double x) { return std::isnan(x) ? 0.0 : x; });
    }
    sum(59) = std::nan("");
    EXPECT_TRUE(near(result.log_density.tail(run.transitions()), sum, drift_digits));
  }
}

TEST(Drifting, WhereNothingIsMeasuredThePredictionStandsIn) {
  const Bank model = example_drifting(2, 1, 2);
  Trajectory run = simulate_drifting(model, 30, 6);
  run.state.middleCols(10, 2).setConstant(std::nan(""));
  const RunEvaluation e = evaluate_run(model, run, {});
  EXPECT_TRUE(near(e.state.middleCols(10, 2), e.prediction.middleCols(10, 2), 0.0));
  EXPECT_TRUE(near(e.state.col(12).head(2), run.state.col(12), 0.0));
  BankFilter filter(model, {});
  Eigen::VectorXd state;  // the state includes its lags
  for (Index k = 0; k <= 12; ++k) state = filter.step(run.time_s(k), run.input.col(k), run.state.col(k)).state;
  EXPECT_TRUE(near(state.tail(2), e.prediction.col(11), 0.0));
  EXPECT_EQ(e.covariance.rightCols(28).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_TRUE(std::isfinite(e.log_density(12)));
}

/// Kolmogorov's distance of N pit values from the uniform distribution, times sqrt(N). If the model is correct, it
/// exceeds 1.95 once in a thousand times.
double scaled_distance(const Bank& filter, const Bank& truth, std::uint64_t seed) {
  const RunEvaluation e = evaluate_run(filter, simulate_drifting(truth, 3000, seed), {});
  std::vector<double> pit;
  for (const double value : e.pit.reshaped())
    if (!std::isnan(value)) pit.push_back(value);
  return kolmogorov_distance(pit) * std::sqrt(static_cast<double>(pit.size()));
}

TEST(Drifting, PitIsUniformWhereTheModelIsTrue) {
  Bank walking = example_drifting(1, 2, 2);
  walking.running_noise.lam = 1.0;  // the variance remains v0
  walking.running_noise.nu = 0.0;   // with other noise the filter of drifting coefficients is approximate
  walking.drift.rates = {0.05, 0.5, 0.95};
  Bank heavy = example_drifting(2, 1, 1);
  heavy.running_noise.lam = 1.0;
  heavy.running_noise.nu = 3.0;
  heavy.drift.rates = {0.0, 0.0, 1.0};
  Bank blind = walking;  // this filter assumes constant coefficients, and the test must detect the error
  blind.drift.rates.q = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_LT(scaled_distance(walking, walking, seed), 1.95) << seed;
    EXPECT_LT(scaled_distance(heavy, heavy, seed), 1.95) << seed;
    EXPECT_GT(scaled_distance(blind, walking, seed), 3.0) << seed;
  }
}

}  // namespace
}  // namespace modebank
