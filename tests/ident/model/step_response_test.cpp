#include "ident/model/step_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace modebank {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double dt_s = 0.1;

/// Increment form of y[k] = a1 y[k-1] + a2 y[k-2] + b u[k-d] for a second-order plant with its poles at
/// radius exp(+-i angle).
VectorXd second_order(double radius, double angle) {
  const double a1 = 2.0 * radius * std::cos(angle), a2 = -radius * radius;
  return Eigen::Vector3d(a1 - 1.0, a2, 3.0 * (1.0 - a1 - a2));
}

TEST(StepResponse, OfFirstOrderIsAnExponential) {
  const double a = std::exp(-1.0 / 20.0), tau_s = 20.0 * dt_s;
  for (const Eigen::Index delay : {1, 6}) {
    const auto [value, error, never] = step_response({1, 1}, Vector2d(a - 1.0, 0.8 * (1.0 - a)), {}, {delay}, dt_s);
    const double dead_s = static_cast<double>(delay - 1) * dt_s, interpolation = dt_s * dt_s / (8.0 * tau_s);
    EXPECT_NEAR(value.response_s(0), tau_s + dead_s, 1e-9);
    EXPECT_NEAR(value.settling_s(0), std::log(20.0) * tau_s + dead_s, interpolation);
    EXPECT_NEAR(value.gain(0), 0.8, 1e-12);
    EXPECT_NEAR(value.overshoot(0), 0.0, 1e-12);
    EXPECT_NEAR(value.radius(0), a, 1e-12);
    EXPECT_TRUE(std::isnan(error.gain(0)) && std::isnan(never(0)));
  }
}

TEST(StepResponse, OfASlowPlantNeedsNoMoreSteps) {
  const double a = std::exp(-1.0 / 50'000.0);
  const StepResponse value = step_response({1, 1}, Vector2d(a - 1.0, 1.0 - a), {}, {1}, dt_s).value;
  EXPECT_NEAR(value.response_s(0), 5000.0, 0.5);
  EXPECT_NEAR(value.settling_s(0), std::log(20.0) * 5000.0, 1.0);
}

/// Sampled finely, so that the zero of the discrete plant does not matter.
TEST(StepResponse, OvershootsAsTheDampingSays) {
  const double damping = 0.4, omega = 0.01, angle = omega * std::sqrt(1.0 - damping * damping);
  const StepResponse value =
      step_response({1, 1, false, 2}, second_order(std::exp(-damping * omega), angle), {}, {1}, dt_s).value;
  EXPECT_NEAR(value.overshoot(0), std::exp(-std::numbers::pi * damping * omega / angle), 1e-3);
  EXPECT_NEAR(value.gain(0), 3.0, 1e-9);
}

/// Two states, each with its own input, and a half sample of dead time by two lags of the inputs.
TEST(StepResponse, HasRowsOfStatesAndColumnsOfInputs) {
  const double a = std::exp(-0.05), c = std::exp(-0.1);
  VectorXd theta(12);  // A, B of lag 0, B of lag 1; second state: half of the first state's steady value
  theta << a - 1.0, 0.0, 0.6 * (1.0 - a), 0.0, 0.4 * (1.0 - a), 0.0, (1.0 - c) / 2.0, c - 1.0, 0.0, 1.0 - c, 0.0, 0.0;
  const StepResponse value = step_response({2, 2, false, 1, 2}, theta, {}, {3, 1}, dt_s).value;
  EXPECT_TRUE(value.gain.isApprox((MatrixXd(2, 2) << 1.0, 0.0, 0.5, 1.0).finished(), 1e-9));
  EXPECT_NEAR(value.response_s(1, 1), 1.0, 1e-9);
  EXPECT_NEAR(value.response_s(0, 0), 2.0 + 0.2 + 0.04, 2e-3);
  EXPECT_TRUE(std::isnan(value.response_s(0, 1)) && std::isnan(value.overshoot(0, 1)));
}

TEST(StepResponse, OfAnIntegratorIsUnknown) {
  const auto [value, error, never] =
      step_response({1, 1}, Vector2d(0.0, 0.1), Vector2d(1e-4, 1e-4).asDiagonal().toDenseMatrix(), {1}, dt_s);
  EXPECT_TRUE(std::isnan(value.gain(0)) && std::isnan(value.response_s(0)) && std::isnan(value.settling_s(0)));
  EXPECT_EQ(value.radius(0), 1.0);
  EXPECT_NEAR(never(0), 0.5, 4.0 * std::sqrt(0.25 / 200.0));
  EXPECT_TRUE(std::isinf(error.gain(0)));
}

/// The delta method; a quantile of 200 draws has a standard error of 8 %.
TEST(StepResponse, ErrorsAreThoseOfTheDeltaMethod) {
  const double a = std::exp(-1.0 / 20.0), b = 1.0 - a, sd_a = 1e-4, sd_b = 2e-4, between = -0.9 * sd_a * sd_b;
  const MatrixXd covariance = (MatrixXd(2, 2) << sd_a * sd_a, between, between, sd_b * sd_b).finished();
  const auto [value, error, never] = step_response({1, 1}, Vector2d(a - 1.0, b), covariance, {1}, dt_s);
  const Vector2d slope(b / (b * b), 1.0 / b);
  const double of_gain = std::sqrt(slope.dot(covariance * slope)), time = dt_s / (a * std::pow(std::log(a), 2)) * sd_a;
  EXPECT_NEAR(error.gain(0) / of_gain, 1.0, 0.24);
  EXPECT_NEAR(error.response_s(0) / time, 1.0, 0.24);
  EXPECT_NEAR(error.settling_s(0) / (std::log(20.0) * time), 1.0, 0.24);
  EXPECT_NEAR(error.radius(0) / sd_a, 1.0, 0.24);
  EXPECT_EQ(never(0), 0.0);
}

}  // namespace
}  // namespace modebank
