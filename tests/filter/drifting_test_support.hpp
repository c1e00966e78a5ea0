#pragma once

#include <Eigen/Core>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/student_t_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <cstdint>
#include <random>

#include "filter/step/bank_filter.hpp"
#include "filter/step/drifting.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank::test {

using Eigen::Index;

/// A stable drifting model of n states with m inputs, an intercept, and `lags` samples of states and inputs.
inline Bank example_drifting(Index n, Index m, Index lags) {
  const LinearStructure structure{n, m, true, lags, lags, 1};
  const Index r = structure.regressors();
  Eigen::MatrixXd theta = Eigen::MatrixXd::Zero(r, n);
  for (Index i = 0; i < n; ++i) {
    theta(i, i) = -0.5;
    if (lags > 1) theta(n + i, i) = 0.2;
    if (n > 1) theta((i + 1) % n, i) = 0.1;
    for (Index j = 0; j < m; ++j) theta(n * lags + j, i) = 0.4 - 0.1 * static_cast<double>(i + j);
    theta(r - 1, i) = 0.05;
  }
  Bank model = one_mode_bank(structure, theta.reshaped(), Eigen::VectorXd::LinSpaced(n, 0.01, 0.02));
  model.drift.scale = Eigen::VectorXd::LinSpaced(r, 0.2, 1.0);
  model.drift.rates = {1e-3, 0.1, 0.97};
  model.running_noise.floor = 1e-3 * model.noise_variance();
  model.running_noise.lam = 0.9;
  model.running_noise.nu = 5.0;
  return model;
}

/// The model with three noise levels, in other units for each output.
inline Bank with_levels(Bank model) {
  const Index n = model.structure.states;
  model.running_noise.level = Eigen::VectorXd::LinSpaced(n, 1.0, 1.5) * Eigen::RowVector3d(0.1, 1.0, 20.0);
  model.running_noise.switching = Eigen::Matrix3d{{0.9, 0.1, 0.0}, {0.05, 0.9, 0.05}, {0.1, 0.2, 0.7}};
  return model;
}

/// The same model with constant coefficients and noise.
inline Bank fixed(Bank model) {
  model.drift = {};
  model.running_noise = {};
  return model;
}

/// Noise of variance one, with the model's type of distribution.
inline double draw_noise(double nu, std::mt19937_64& generator) {
  if (nu == 0.0) return boost::random::normal_distribution<double>()(generator);
  return boost::random::student_t_distribution<double>(nu)(generator) * std::sqrt((nu - 2.0) / nu);
}

/// A run of the model with constant variance v0. It starts at zero with coefficients drawn from cov(theta[first]).
inline Trajectory simulate_drifting(const Bank& model, Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_01<double> uniform;
  const LinearStructure& s = model.structure;
  Trajectory run;
  run.run = "simulated";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state = Eigen::MatrixXd::Zero(s.states, samples);
  run.input.resize(s.inputs, samples);
  for (double& u : run.input.reshaped()) u = 2.0 * uniform(generator) - 1.0;
  const DriftingModel scaled(model);
  const Eigen::MatrixXd& theta0 = scaled.theta0;
  Eigen::MatrixXd theta = theta0;
  const auto wander = [&](double variance) {
    for (Index i = 0; i < s.states; ++i)
      for (double& value : theta.col(i)) value += std::sqrt(variance * model.noise_variance()(i)) * normal(generator);
  };
  Eigen::VectorXd z = Eigen::VectorXd::Zero(s.dimension()), v(s.acting_inputs()), h(s.regressors());
  for (Index k = s.first_transition() + 1; k < samples; ++k) {
    if (k == s.first_transition() + 1) {
      wander(model.drift.rates.p0);
    } else {
      theta = theta0 + model.drift.rates.leak * (theta - theta0);
      wander(model.drift.rates.q);
    }
    for (Index i = 0; i < s.input_lags; ++i)
      for (Index j = 0; j < s.inputs; ++j) v(i * s.inputs + j) = run.input(j, k - s.input_delay[j] - i);
    scaled.fill(z, v, h);
    run.state.col(k) = run.state.col(k - 1) + theta.transpose() * h;
    for (Index i = 0; i < s.states; ++i)
      run.state(i, k) += std::sqrt(model.noise_variance()(i)) * draw_noise(model.running_noise.nu, generator);
    scaled.push(run.state.col(k), z);
  }
  return run;
}

/// The run with missing samples, missing signals, a short gap and a long gap.
inline Trajectory holed(Trajectory run) {
  run.state.col(0).setConstant(std::nan(""));
  run.state.middleCols(20, 3).setConstant(std::nan(""));
  run.state(0, 30) = std::nan("");
  run.state.row(0).segment(40, 5).setConstant(std::nan(""));
  run.state(run.state.rows() - 1, 43) = std::nan("");
  run.time_s.tail(run.samples() - 60).array() += 3.0;
  run.time_s.tail(run.samples() - 90).array() += 60.0;
  return run;
}

}  // namespace modebank::test
