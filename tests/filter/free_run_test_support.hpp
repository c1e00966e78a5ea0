#pragma once

#include <Eigen/Core>
#include <cmath>

#include "filter/judge/horizon.hpp"
#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank::test {

using Eigen::Index;

inline FreeRunOptions after(Index samples, Index paths = 400) {
  FreeRunOptions options;
  options.samples = samples;
  options.paths = paths;
  return options;
}

/// The same bank with a logit of no weight: free runs take sample paths.
inline Bank with_paths(Bank bank) {
  const Index d = bank.structure.dimension() + bank.structure.acting_inputs();
  bank.transition_logit = {Eigen::MatrixXd::Zero(bank.mode_count(), d), Eigen::VectorXd::Zero(d)};
  return bank;
}

/// A bank of one mode with exactly measured states.
inline Bank arx_bank(const LinearStructure& s, const Eigen::VectorXd& theta) {
  return one_mode_bank(s, theta, Eigen::VectorXd::Ones(s.states));
}

/// theta of a stable model: -0.4, then small values for each older sample.
inline Eigen::VectorXd stable_theta(const LinearStructure& s) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(s.regressors(), s.states);
  for (Index i = 0; i < s.states; ++i) {
    for (Index lag = 0; lag < s.state_lags; ++lag)
      rows(lag * s.states + i, i) = lag == 0 ? -0.4 : 0.1 / static_cast<double>(lag);
    rows.col(i).segment(s.dimension(), s.acting_inputs()).setLinSpaced(0.3, -0.2);
    if (s.states > 1) rows((i + 1) % s.states, i) = 0.05;
    if (s.intercept) rows(s.regressors() - 1, i) = 0.02;
  }
  return rows.reshaped();
}

inline Trajectory any_run(const LinearStructure& s, Index samples) {
  Trajectory run;
  run.run = "any";
  run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, static_cast<double>(samples - 1));
  run.state.resize(s.states, samples);
  run.input.resize(s.inputs, samples);
  for (Index k = 0; k < samples; ++k) {
    for (Index i = 0; i < s.states; ++i) run.state(i, k) = std::sin(0.7 * static_cast<double>(k + i));
    for (Index i = 0; i < s.inputs; ++i)
      run.input(i, k) = std::cos(1.3 * static_cast<double>(k) + static_cast<double>(i));
  }
  return run;
}

}  // namespace modebank::test
