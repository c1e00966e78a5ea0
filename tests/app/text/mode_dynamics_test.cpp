#include "app/text/mode_dynamics.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/report/page/run_sections.hpp"

namespace modebank {
namespace {

constexpr double dynamics_rounding = 1e-12;

Bank bank_of(const LinearStructure& structure, const Eigen::VectorXd& theta, double dt_s) {
  Bank bank;
  bank.structure = structure;
  bank.modes.resize(1);
  bank.modes[0].model = unpack(structure, theta);
  bank.C = Eigen::MatrixXd::Identity(structure.states, structure.dimension());
  bank.dt_s = dt_s;
  return bank;
}

Eigen::VectorXd vector(std::initializer_list<double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size()));
}

/// x[k+1] = e^(-dt/tau) x[k] + (1 - e^(-dt/tau)) g u[k] is the exact step response of tau x' = g u - x.
TEST(ModeDynamics, FirstOrderLag) {
  const double dt = 0.1, tau = 0.7, gain = -2.5, a = std::expm1(-dt / tau);
  const ModeDynamics dynamics = mode_dynamics(bank_of({1, 1}, vector({a, -a * gain}), dt), 0);
  ASSERT_EQ(dynamics.decays.size(), 1u);
  EXPECT_NEAR(dynamics.decays[0].time_constant_s, tau, dynamics_rounding);
  EXPECT_EQ(dynamics.decays[0].frequency_hz, 0.0);
  EXPECT_NEAR(dynamics.gain(0, 0), gain, dynamics_rounding);
}

/// y[k+1] = 1.02 y[k] + 0.1 u[k] grows, so (-A)^-1 B = -5 does not count as a gain.
TEST(ModeDynamics, WhatGrowsOrIntegratesHasNoSteadyGain) {
  for (const double a : {0.02, 0.0, -2.1}) {
    Bank bank = bank_of({1, 1}, vector({a, 0.1}), 0.1);
    bank.modes[0].standard_error = vector({1e-3, 1e-3});
    const ModeDynamics dynamics = mode_dynamics(bank, 0);
    EXPECT_TRUE(std::isnan(dynamics.gain(0, 0)) && std::isnan(dynamics.gain_error(0, 0))) << a;
  }
}

/// A rotation by w dt that decays with tau. It has one conjugate pair.
TEST(ModeDynamics, DampedOscillation) {
  const double dt = 0.05, tau = 2.0, hertz = 1.5, angle = 2 * std::numbers::pi * hertz * dt, size = std::exp(-dt / tau);
  const double c = size * std::cos(angle), s = size * std::sin(angle);
  const ModeDynamics dynamics = mode_dynamics(bank_of({2, 1}, vector({c - 1, -s, 1, s, c - 1, 0}), dt), 0);
  ASSERT_EQ(dynamics.decays.size(), 1u);
  EXPECT_NEAR(dynamics.decays[0].time_constant_s, tau, dynamics_rounding);
  EXPECT_NEAR(dynamics.decays[0].frequency_hz, hertz, dynamics_rounding);
  // The gain is the fixed point of x = (I + A) x + B.
  Eigen::Matrix2d A;
  A << c - 1, -s, s, c - 1;
  const Eigen::Vector2d fixed = -A.inverse() * Eigen::Vector2d(1, 0);
  EXPECT_NEAR((dynamics.gain - fixed).norm(), 0.0, dynamics_rounding);
}

/// An input that is held over all lags acts with the sum of its coefficients. The coefficients of the state's lags are
/// also summed.
TEST(ModeDynamics, LaggedModelsGainIsThatOfTheirSums) {
  const LinearStructure structure{1, 2, false, 2, 2, 1};  // order of theta: A_lag1 A_lag2 B1_lag1 B2_lag1 B1_lag2
                                                          // B2_lag2
  const ModeDynamics dynamics = mode_dynamics(bank_of(structure, vector({-0.5, 0.1, 0.3, -0.2, 0.1, -0.4}), 0.1), 0);
  ASSERT_EQ(dynamics.gain.cols(), 2);
  EXPECT_NEAR(dynamics.gain(0, 0), 0.4 / 0.4, dynamics_rounding);
  EXPECT_NEAR(dynamics.gain(0, 1), -0.6 / 0.4, dynamics_rounding);
  // lambda^2 = 0.5 lambda + 0.1 has one positive and one negative root.
  ASSERT_EQ(dynamics.decays.size(), 2u);
  const double root = std::sqrt(0.25 + 0.4);
  EXPECT_NEAR(dynamics.decays[0].time_constant_s, -0.1 / std::log((0.5 + root) / 2), dynamics_rounding);
  EXPECT_NEAR(dynamics.decays[1].time_constant_s, -0.1 / std::log((root - 0.5) / 2), dynamics_rounding);
  EXPECT_NEAR(dynamics.decays[1].frequency_hz, 5.0, dynamics_rounding);  // a negative root alternates at half the
                                                                         // sample rate
}

TEST(ModeDynamics, IntegratorsDeadBeatAndGrowth) {
  const ModeDynamics integrator = mode_dynamics(bank_of({1, 1}, vector({0.0, 0.2}), 0.1), 0);
  EXPECT_EQ(integrator.decays[0].time_constant_s, std::numeric_limits<double>::infinity());
  EXPECT_EQ(mode_dynamics(bank_of({1, 1}, vector({-1.0, 0.2}), 0.1), 0).decays[0].time_constant_s, 0.0);
  EXPECT_NEAR(mode_dynamics(bank_of({1, 1}, vector({std::expm1(0.1), 0.2}), 0.1), 0).decays[0].time_constant_s, -1.0,
              dynamics_rounding);
  EXPECT_EQ(mode_dynamics(bank_of({1, 0}, vector({-0.3}), 0.1), 0).gain.cols(), 0);
}

/// A scalar AR(1) with one input. tau = -dt / log(1 + A), so dtau/dA = dt / ((1 + A) log^2(1 + A)). g = -B / A.
TEST(ModeDynamics, StandardErrorsAreTheDeltaMethods) {
  const double dt = 0.2, A = -0.4, B = 0.3;
  Bank bank = bank_of({1, 1}, vector({A, B}), dt);
  Mode& mode = bank.modes[0];
  EXPECT_TRUE(std::isnan(mode_dynamics(bank, 0).gain_error(0, 0)));  // here the covariance of theta is unknown
  Eigen::Matrix2d covariance;
  covariance << 4e-4, -2.4e-4, -2.4e-4, 9e-4;
  mode.standard_error = covariance.diagonal().cwiseSqrt();
  const double log_left = std::log(1.0 + A), of_tau = dt / ((1.0 + A) * log_left * log_left);
  const auto error_of_gain = [&](const Eigen::Matrix2d& of_theta) {
    const Eigen::Vector2d gradient(B / (A * A), -1.0 / A);
    return std::sqrt(gradient.dot(of_theta * gradient));
  };
  constexpr double rounding = 1e-8;
  const ModeDynamics apart = mode_dynamics(bank, 0);
  EXPECT_NEAR(apart.decays[0].per_sample, 0.6, dynamics_rounding);
  EXPECT_NEAR(apart.decays[0].time_constant_error_s, 0.02 * of_tau, rounding);
  EXPECT_NEAR(apart.gain_error(0, 0), error_of_gain(covariance.diagonal().asDiagonal()), rounding);
  mode.parameter_covariance = 25.0 * covariance;  // covariance over windows, which is larger than that of their mean
  EXPECT_NEAR(mode_dynamics(bank, 0).gain_error(0, 0), error_of_gain(covariance), rounding);
  add_responses(bank);
  EXPECT_NEAR(mode.response.value.gain(0, 0), -B / A, rounding);
  const double crossed = (0.6 - std::exp(-1.0)) / (0.6 - 0.36);  // between samples 1 and 2, where 0.6 and 0.36 are left
  EXPECT_NEAR(mode.response.value.response_s(0, 0), (1.0 + crossed) * dt, rounding);
  EXPECT_NEAR(mode.response.error.gain(0, 0), error_of_gain(covariance), 0.3 * error_of_gain(covariance));
}

/// The eigenvalues of a rotation have modulus sqrt(det(I + A)) for any angle. s has no error here, so only c matters.
TEST(ModeDynamics, OscillationsErrorsFollowTheEigenvaluesSize) {
  const double dt = 0.1, c = 0.6, s = 0.5, size = std::hypot(c, s), error = 1e-3;
  Bank bank = bank_of({2, 0}, vector({c - 1, -s, s, c - 1}), dt);
  bank.modes[0].standard_error = vector({error, 0, 0, 0});
  const Decay decay = mode_dynamics(bank, 0).decays.at(0);
  EXPECT_NEAR(decay.per_sample, size, dynamics_rounding);
  // det = a c + s^2 with a = c + e. At constant c, d size / d a = c / (2 size).
  const double of_size = c / (2 * size), log_size = std::log(size);
  EXPECT_NEAR(decay.time_constant_error_s, error * of_size * dt / (size * log_size * log_size), 1e-9);
}

TEST(WindowModes, TheMostProbableOverTheTransitions) {
  RunEvaluation evaluation;
  evaluation.mode_probability.resize(2, 5);
  evaluation.mode_probability << 0.9, 0.2, 0.3, std::nan(""), 0.9,  //
      0.1, 0.8, 0.7, std::nan(""), 0.1;
  const Eigen::VectorXi modes = app::report::window_modes({{0, 0}, {0, 2}, {0, 1}}, 2, {"bank", {evaluation}});
  EXPECT_EQ(modes(0), 1);  // from samples 1 and 2; no transition ends at the window's first sample
  EXPECT_EQ(modes(1), 0);  // from sample 4, because sample 3 is unknown
  EXPECT_EQ(modes(2), 1);
  EXPECT_EQ(app::report::window_modes({{0, 2}}, 1, {"bank", {evaluation}})(0), -1);
}

}  // namespace
}  // namespace modebank
