// Predictions by the drifting model some samples ahead.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "filter/judge/run/drifting.hpp"
#include "filter/step/drifting_forecast.hpp"
#include "ident/base/linalg.hpp"
#include "tests/filter/drifting_test_support.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::example_drifting;
using test::fixed;
using test::near;
using test::simulate_drifting;

constexpr double ahead_digits = 1e-10;

TEST(DriftingHorizon, OneSampleAheadIsTheFilter) {
  for (const Index n : {1, 2}) {
    Bank model = example_drifting(n, 1, 2);
    model.modes.front().model.A(0, 0) = 0.4;  // unstable
    model.running_noise.horizon_factor = {{2, 3.0}};
    const Trajectory run = simulate_drifting(example_drifting(n, 1, 2), 150, 2);
    const RunEvaluation one = evaluate_run(model, run, {});
    const HorizonEvaluation ahead = evaluate_horizons(model, run, {}, {1});
    EXPECT_TRUE(near(ahead.log_density.row(0).transpose(), one.log_density, ahead_digits));
    EXPECT_TRUE(near(ahead.error[0], one.innovation, ahead_digits));
  }
}

/// Without drift the model is ARX. Its variance is v times the sum of squares of the impulse response.
TEST(DriftingHorizon, FixedCoefficientsHaveTheImpulseResponsesVariance) {
  Bank model = example_drifting(1, 1, 2);
  model.drift.rates = {0.0, 0.0, 1.0};
  model.running_noise.lam = 1.0;
  const Trajectory run = simulate_drifting(model, 60, 9);
  const double a1 = 1.0 + model.theta(0)(0), a2 = model.theta(0)(1);
  const std::vector<Index> horizons{1, 2, 3, 7, 20};
  const DriftingForecasts forecasts = drifting_forecasts(model, run, horizons);
  for (std::size_t h = 0; h < horizons.size(); ++h) {
    double sum = 0.0, now = 1.0, before = 0.0;
    for (Index j = 0; j < horizons[h]; ++j) {
      sum += now * now;
      const double next = a1 * now + a2 * before;
      before = now;
      now = next;
    }
    for (Index k = 1 + horizons[h]; k < run.samples(); ++k)
      EXPECT_NEAR(
          std::pow(forecasts.predictions.error[h](0, k) / forecasts.whitened[h](0, k), 2) / model.noise_variance()(0),
          sum, ahead_digits)
          << "horizon " << horizons[h];
  }
}

/// With fixed coefficients and several outputs, the result is the Gaussian prediction of a bank with one mode.
TEST(DriftingHorizon, FixedCoefficientsOfSeveralOutputsAreOneKalmanFilter) {
  Bank model = example_drifting(3, 2, 2);
  model.drift.rates = {0.0, 0.0, 1.0};
  model.running_noise.lam = 1.0;
  model.running_noise.nu = 0.0;
  const Trajectory run = simulate_drifting(model, 60, 9);
  const HorizonEvaluation drifting = evaluate_horizons(model, run, {}, {1, 2, 6});
  const HorizonEvaluation bank = evaluate_horizons(fixed(model), run, {FilterVariant::kf}, {1, 2, 6});
  EXPECT_TRUE(near(drifting.log_density, bank.log_density, 1e3 * ahead_digits));
  for (std::size_t h = 0; h < 3; ++h) {
    EXPECT_TRUE(near(drifting.error[h], bank.error[h], ahead_digits));
    EXPECT_TRUE(near(drifting.pit[h], bank.pit[h], 1e3 * ahead_digits));
  }
}

/// If the model is correct and drifts slowly, errors have the predicted variance.
TEST(DriftingHorizon, ErrorsAreAsLargeAsStated) {
  Bank model = example_drifting(2, 1, 2);
  model.drift.rates = {2e-3, 0.05, 0.98};
  model.running_noise.lam = 1.0;
  model.running_noise.nu = 0.0;
  const std::vector<Index> horizons{2, 6};
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  Eigen::Vector2d count = Eigen::Vector2d::Zero();
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const DriftingForecasts f = drifting_forecasts(model, simulate_drifting(model, 2000, seed), horizons);
    for (Index h = 0; h < 2; ++h)
      for (const double u : f.whitened[static_cast<std::size_t>(h)].reshaped())
        if (!std::isnan(u)) {
          squares(h) += u * u;
          ++count(h);
        }
  }
  // 40,000 values. Because of their autocorrelation they are worth less, but at least a tenth of that number. Six
  // standard errors are allowed.
  EXPECT_NEAR(squares(0) / count(0), 1.0, 6.0 * std::sqrt(2.0 / (0.1 * count(0))));
  EXPECT_NEAR(squares(1) / count(1), 1.0, 6.0 * std::sqrt(2.0 / (0.1 * count(1))));
}

TEST(DriftingHorizon, FactorWidensEveryVariance) {
  Bank model = example_drifting(2, 1, 1);
  model.running_noise.nu = 0.0;
  const Trajectory run = simulate_drifting(model, 50, 5);
  const HorizonEvaluation plain = evaluate_horizons(model, run, {}, {1, 3, 5, 8});
  const DriftingForecasts f = drifting_forecasts(model, run, {1, 3, 5, 8});
  model.running_noise.horizon_factor = {{3, 4.0}, {8, 0.5}};
  const HorizonEvaluation wide = evaluate_horizons(model, run, {}, {1, 3, 5, 8});
  const std::vector<double> factors{1.0, 4.0, 4.0, 0.5};  // horizon 5 has the factor of horizon 3
  for (Index h = 0; h < 4; ++h)
    for (Index k = 10; k < run.samples(); ++k) {
      const double c = factors[static_cast<std::size_t>(h)];
      const double square = f.whitened[static_cast<std::size_t>(h)].col(k).squaredNorm();
      EXPECT_NEAR(wide.log_density(h, k), plain.log_density(h, k) - std::log(c) - 0.5 * square * (1.0 / c - 1.0),
                  ahead_digits);
    }
}

TEST(DriftingHorizon, ContractionDividesEveryRootByTheLargest) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  int unstable = 0;
  for (int repetition = 0; repetition < 40; ++repetition) {
    const LinearStructure s{1 + repetition % 3, 1, true, 1 + repetition % 4, 1, 1};
    const Eigen::VectorXd scale = Eigen::VectorXd::LinSpaced(s.regressors(), 0.5, 2.0);
    Eigen::MatrixXd theta(s.regressors(), s.states);
    for (double& value : theta.reshaped()) value = 0.6 * normal(generator);
    const Eigen::MatrixXd result = contracted(s, scale, theta);
    const auto roots = [&](const Eigen::MatrixXd& scaled) {
      const Eigen::MatrixXd physical = scale.cwiseInverse().asDiagonal() * scaled;
      Eigen::VectorXd moduli = eigenvalues(unpack(s, Eigen::VectorXd(physical.reshaped())).full_form()).cwiseAbs();
      std::sort(moduli.begin(), moduli.end());
      return moduli;
    };
    const Eigen::VectorXd before = roots(theta), after = roots(result);
    const double largest = before(before.size() - 1);
    unstable += largest > 1.0 ? 1 : 0;
    if (largest <= 1.0) {
      EXPECT_EQ(result, theta);
    }
    EXPECT_TRUE(near(after, before / std::max(1.0, largest), 1e-9));
    EXPECT_EQ(result.bottomRows(2), theta.bottomRows(2)) << "inputs and intercept stay";
  }
  EXPECT_GT(unstable, 10);
  EXPECT_LT(unstable, 40);
}

}  // namespace
}  // namespace modebank
