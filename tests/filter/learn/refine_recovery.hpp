#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "filter/judge/diagnostics.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/refine/refine.hpp"
#include "tests/filter/filter_test_support.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank::test {

/// A bank for simulation. `theta`: one column per mode. `stay`: diagonal of T. `R`: diagonal of R.
inline Bank true_bank(const LinearStructure& structure, const Eigen::MatrixXd& theta,
                      const std::vector<Eigen::MatrixXd>& Q, const Eigen::VectorXd& R, double stay) {
  Bank bank = bank_frame(empty_recording(structure.states, structure.inputs), structure, R.asDiagonal());
  for (Index j = 0; j < theta.cols(); ++j) bank.modes.push_back(make_mode(structure, theta.col(j), Q[j], {}, {}, 1.0));
  set_mode_sequence(bank, TransitionMatrix::sticky(theta.cols(), stay));
  return bank;
}

/// A pendulum (angle, rate) driven by a torque, with one mode per damping. R is `R_factor` times that of sensors.
inline Bank true_pendulum(const std::vector<double>& dampings, double R_factor) {
  const double dt = 0.02, torque = 70.0;
  Eigen::MatrixXd theta(6, std::ssize(dampings));
  for (Index j = 0; j < theta.cols(); ++j) theta.col(j) << 0.0, dt, 0.0, -9.81 * dt, -dampings[j] * dt, torque * dt;
  const Eigen::MatrixXd Q = Eigen::Vector2d(2.5e-7, 1e-4).asDiagonal();
  return true_bank({2, 1, false}, theta, std::vector<Eigen::MatrixXd>(dampings.size(), Q),
                   R_factor * Eigen::Vector2d(4e-6, 4e-4), 0.995);
}

/// Two states, two inputs, two modes; R is about `R_factor` times Q.
inline Bank true_pair(double R_factor) {
  Eigen::MatrixXd theta(8, 2);
  theta.col(0) << -0.2, 0.1, 1.5, 0.0, 0.0, -0.3, 0.3, 1.2;
  theta.col(1) << -0.5, 0.0, 3.0, 0.6, 0.2, -0.6, 0.0, 3.0;
  const Eigen::MatrixXd Q{{0.02, 0.005}, {0.005, 0.03}};
  return true_bank({2, 2, false}, theta, {Q, 2.0 * Q}, R_factor * Eigen::Vector2d(0.02, 0.03), 0.975);
}

/// One state, one input, two modes.
inline Bank true_scalar(double R_factor) {
  const Eigen::MatrixXd theta{{-0.2, -0.6}, {1.0, 3.0}};
  return true_bank({1, 1, false}, theta, {Eigen::MatrixXd{{0.01}}, Eigen::MatrixXd{{0.04}}},
                   Eigen::VectorXd::Constant(1, 0.01 * R_factor), 0.965);
}

/// Three modes, exactly measured.
inline Bank true_three() {
  Bank bank = true_bank({1, 1, false}, Eigen::MatrixXd{{-0.2, -0.2, -0.6}, {1.0, 3.5, 2.0}},
                        {Eigen::MatrixXd{{0.0025}}, Eigen::MatrixXd{{0.01}}, Eigen::MatrixXd{{0.04}}},
                        Eigen::VectorXd::Zero(1), 0.96);
  bank.transition = TransitionMatrix(Eigen::Matrix3d{{0.96, 0.03, 0.01}, {0.02, 0.96, 0.02}, {0.02, 0.02, 0.96}});
  return bank;
}

inline Recording simulated_recording(const Bank& truth, Index runs, Index samples, std::uint64_t seed) {
  Recording recording = empty_recording(truth.structure.states, truth.structure.inputs);
  for (Index i = 0; i < runs; ++i) {
    recording.runs.push_back(simulate_truth(truth, samples, 1000 * seed + static_cast<std::uint64_t>(i)).run);
    recording.runs.back().run += std::to_string(i);
  }
  return recording;
}

/// A start like that from clustered windows: theta is shrunk, Q includes measurement noise, stays are short.
inline Bank blurred(const Bank& truth, const Recording& recording) {
  Bank start = bank_frame(recording, truth.structure, 1e-3 * truth.R);
  for (Index j = 0; j < truth.mode_count(); ++j)
    start.modes.push_back(
        make_mode(truth.structure, 0.9 * truth.theta(j), truth.modes[j].Q + 2.0 * truth.R, {}, {}, 1.0));
  set_mode_sequence(start, TransitionMatrix::sticky(truth.mode_count(), 0.95));
  return start;
}

inline Refinement refine_blurred(const Bank& truth, const Recording& recording, Index folds,
                                 Index max_iterations = 100) {
  const RefineOptions options{.max_iterations = max_iterations, .restarts = 0, .folds = folds};
  return refine_bank(recording, windows_of(recording, 25, 1), {blurred(truth, recording)}, options, {});
}

/// The mode of the bank whose theta is nearest.
inline Index nearest_mode(const Bank& bank, const Eigen::VectorXd& theta) {
  Index nearest = 0;
  for (Index j = 1; j < bank.mode_count(); ++j)
    if ((bank.theta(j) - theta).norm() < (bank.theta(nearest) - theta).norm()) nearest = j;
  return nearest;
}

/// Errors of all learned parameters in standard errors: theta, Q (lower triangles), R if learned, T's diagonal.
inline std::vector<double> z_values(const Bank& bank, const Bank& truth) {
  std::vector<double> z;
  const Index n = truth.structure.states;
  for (Index j = 0; j < truth.mode_count(); ++j) {
    const Index k = nearest_mode(bank, truth.theta(j));
    const Mode& mode = bank.modes[k];
    const Mode& right = truth.modes[j];
    for (Index a = 0; a < truth.structure.parameters(); ++a)
      z.push_back((bank.theta(k)(a) - truth.theta(j)(a)) / mode.standard_error(a));
    for (Index b = 0; b < n; ++b)
      for (Index a = b; a < n; ++a) z.push_back((mode.Q(a, b) - right.Q(a, b)) / mode.Q_standard_error(a, b));
    if (truth.mode_count() > 1)
      z.push_back((bank.transition.matrix()(k, k) - truth.transition.matrix()(j, j)) /
                  bank.transition_standard_error(k, k));
  }
  for (Index i = 0; i < bank.R_standard_error.rows(); ++i)
    z.push_back((bank.R(i, i) - truth.R(i, i)) / bank.R_standard_error(i, i));
  return z;
}

/// Diagnostics of a bank on unseen runs.
inline DiagnosticsRow held_out_diagnostics(const Bank& bank, const Bank& truth, std::uint64_t seed) {
  return row_of(bank, simulated_recording(truth, 4, 1000, seed + 1000).runs);
}

}  // namespace modebank::test
