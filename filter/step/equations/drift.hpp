#pragma once

#include <Eigen/Core>

#include "filter/step/equations/imm.hpp"

/// Modes with coefficients that drift within a run, for an exactly measured state (R = 0). Each mode k has its own
/// Gaussian of theta with mean m_k and covariance s P_k, where s is the noise scale. The Gaussian starts from theta_k
/// and P0_k. It is never mixed with that of another mode. G is the matrix of regressors in x[k+1] = x + G' theta + w.
///
/// - Prediction of y: the mean of mode k uses m_k for theta; S_k = s (Q_k + G_k' P_k G_k).
/// - Update: if mode k ruled the step, theta has mean m_k + g and covariance P_k - D, with the Kalman filter's g and D.
///   Otherwise theta is unchanged. These cases have the probabilities mu_k and 1 - mu_k after the measurement. Matching
///   mean and covariance gives
///       m_k + mu_k g,   P_k - mu_k D + mu_k (1 - mu_k) g g' / s.
/// - Then time passes: m_k <- theta_k + leak (m_k - theta_k),   P_k <- leak^2 P_k + W_k.
///
/// Without a measurement the error of the state is correlated with the error of theta (`cross`). Predictions several
/// steps ahead include this correlation to first order, like the extended Kalman filter of (theta, x). With W = P0 = 0
/// the filter equals the filter of the bank without drift. With one mode of diagonal Q it equals DriftingRecursion.
///
/// Modes that share theta (`one_motion`) have one common Gaussian. g_k and D_k are the change of mean and covariance if
/// mode k ruled the step:
///   m + sum_k mu_k g_k,   P + sum_k mu_k ((g_k - g)(g_k - g)' / s - D_k),  g = sum_k mu_k g_k.
namespace modebank::drift {

/// Sets [A B (c)] of a mode from its theta; companion rows are unchanged.
template <class Mode, class Theta>
void set_coefficients(const LinearStructure& s, const Theta& theta, Mode& mode) {
  const Eigen::Index n = s.dimension(), m = s.acting_inputs(), r = s.regressors();
  for (Eigen::Index a = 0; a < s.states; ++a) {
    for (Eigen::Index i = 0; i < n; ++i) {
      mode.A(a, i) = theta(a * r + i);
      mode.F(a, i) = theta(a * r + i) + (a == i ? 1.0 : 0.0);
    }
    for (Eigen::Index i = 0; i < m; ++i) mode.B(a, i) = theta(a * r + n + i);
    if (s.intercept) mode.c(a) = theta(a * r + r - 1);
    for (Eigen::Index i = 0; !s.centre.empty() && i < n + m; ++i) mode.c(a) -= theta(a * r + i) * s.centre_of(i);
  }
}

/// step.drift.mixed: covariance of mode j's theta with the error of the state from which mode j's prediction starts.
/// Only the part of this state that comes from mode j is correlated with theta_j. If the modes share theta, the whole
/// state is correlated with theta.
template <int N, int NY>
void mix_cross(const FilterModel<N, NY>& model, const FilterState<N>& state, std::size_t j, FilterStep<N, NY>& step) {
  const auto k = static_cast<Eigen::Index>(j);
  Eigen::MatrixXd& mixed = step.drift.mixed;
  if (model.mode_count() == 1)
    mixed = state.drift.cross[j];
  else if (model.drift.shared) {
    mixed.setZero();
    for (std::size_t i = 0; i < state.drift.cross.size(); ++i)
      mixed += step.mixing.matrix(static_cast<Eigen::Index>(i), k) * state.drift.cross[i];
  } else
    mixed = step.mixing.matrix(k, k) * state.drift.cross[j];
}

/// Adds the effect of theta's errors to the prediction of mode j, which used the mean of theta. Call after mix_cross.
template <int N, int NY, class U>
void add_errors(const FilterModel<N, NY>& model, const FilterState<N>& state, std::size_t j, const Gaussian<N>& from,
                const U& u, FilterStep<N, NY>& step) {
  const LinearStructure& s = model.structure;
  const Eigen::Index n_s = s.states, n = s.dimension(), r = s.regressors();
  DriftWorkspace<N, NY>& at = step.drift;
  KalmanStep<N, NY>& kalman = step.kalman[j];
  const auto& F = at.modes[j].F;
  const Eigen::MatrixXd& theta_P = state.drift.P[model.drift.owner(j)];
  fill_regressor(s, from.mean, u, at.regressor);
  for (Eigen::Index a = 0; a < n_s; ++a) {
    at.PG.col(a).noalias() = state.noise_scale * (theta_P.middleCols(a * r, r) * at.regressor);
    at.through.row(a).noalias() = at.regressor.transpose() * at.mixed.middleRows(a * r, r);
  }
  small::multiply_transposed(at.cross[j], at.mixed, F);
  at.cross[j].leftCols(n_s) += at.PG;
  auto& P = kalman.predicted.covariance;
  for (Eigen::Index b = 0; b < n_s; ++b) {
    for (Eigen::Index a = b; a < n_s; ++a) {
      const double own = at.regressor.dot(at.PG.col(b).segment(a * r, r));
      kalman.process_noise(a, b) += own;
      P(a, b) += own;
      kalman.process_noise(b, a) = kalman.process_noise(a, b);
      P(b, a) = P(a, b);
    }
    for (Eigen::Index i = 0; i < n; ++i) {
      const double with_state = F.row(i).dot(at.through.row(b));
      P(i, b) += with_state;
      P(b, i) += with_state;
    }
  }
  make_usable(kalman.predicted);
}

/// Step 3 of imm.hpp, with the modes' present coefficients.
template <int N, int NY, class U>
void predict_modes(const FilterModel<N, NY>& model, const FilterState<N>& state, const std::vector<Gaussian<N>>& from,
                   const U& u, FilterStep<N, NY>& step) {
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    const auto owner = static_cast<Eigen::Index>(model.drift.owner(j));
    set_coefficients(model.structure, state.drift.theta.col(owner), step.drift.modes[j]);
    step.kalman[j].predict(from[j], model, step.drift.modes[j], u, state.noise_scale);
    mix_cross(model, state, j, step);
    add_errors(model, state, j, from[j], u, step);
    step.kalman[j].expect(model);
  }
}

/// Advances time between two samples: coefficients leak towards theta_k and drift.
inline void pass_time(const DriftModel& model, DriftState& state) {
  if (model.leak != 1.0) state.theta = model.theta0 + model.leak * (state.theta - model.theta0);
  for (std::size_t k = 0; k < state.P.size(); ++k) {
    if (model.leak != 1.0) state.P[k] *= model.leak * model.leak;
    state.P[k] += model.W[k];
  }
  if (model.leak != 1.0)
    for (Eigen::MatrixXd& cross : state.cross) cross *= model.leak;
}

/// For a step without measurement: theta is unchanged, and the error of the predicted state remains correlated with the
/// error of theta.
template <int N, int NY>
void keep_prediction(const FilterModel<N, NY>& model, const FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < state.drift.cross.size(); ++j) state.drift.cross[j] = step.drift.cross[j];
  pass_time(model.drift, state.drift);
}

/// Sets step.drift.gain and step.drift.move: the update of mode j's theta if mode j produced the measurement.
template <int N, int NY, class Sensor>
void match(const Sensor& sensor, std::size_t j, FilterStep<N, NY>& step) {
  DriftWorkspace<N, NY>& at = step.drift;
  const KalmanStep<N, NY>& kalman = step.kalman[j];
  small::multiply_transposed(at.G, at.cross[j], sensor.C);
  for (Eigen::Index i = 0; i < at.G.rows(); ++i) {
    at.row = at.G.row(i);
    kalman.cholesky.solve(at.row);
    at.gain.row(i) = at.row;
  }
  small::multiply(at.move, at.gain, kalman.innovation);
}

/// P + weight (scatter move move' - gain G'). Call after match.
template <int N, int NY>
void learn_covariance(const DriftWorkspace<N, NY>& at, double weight, double scatter, Eigen::MatrixXd& P) {
  for (Eigen::Index b = 0; b < P.cols(); ++b)
    for (Eigen::Index a = b; a < P.rows(); ++a) {
      double known = 0.0;
      for (Eigen::Index i = 0; i < at.G.cols(); ++i) known += at.gain(a, i) * at.G(b, i);
      P(a, b) += weight * (scatter * at.move(a) * at.move(b) - known);
      P(b, a) = P(a, b);
    }
}

/// Covariance of mode j's state error with theta after both updates. Call after match.
template <int N, int NY, class Sensor>
void learn_cross(const Sensor& sensor, std::size_t j, FilterStep<N, NY>& step, DriftState& state) {
  DriftWorkspace<N, NY>& at = step.drift;
  small::multiply_transposed(at.seen, step.kalman[j].predicted.covariance, sensor.C);
  state.cross[j] = at.cross[j];
  for (Eigen::Index i = 0; i < at.gain.cols(); ++i)
    state.cross[j].noalias() -= at.gain.col(i) * at.seen.col(i).transpose();
}

/// Updates mode j's theta with a measurement. `mu`: probability that mode j produced the measurement. `scale`: noise
/// scale of the prediction.
template <int N, int NY, class Sensor>
void learn_mode(const Sensor& sensor, std::size_t j, double mu, double scale, FilterStep<N, NY>& step,
                DriftState& state) {
  match(sensor, j, step);
  if (!step.drift.move.allFinite()) {  // a correction that overflows is ignored
    state.cross[j] = step.drift.cross[j];
    return;
  }
  state.theta.col(static_cast<Eigen::Index>(j)) += mu * step.drift.move;
  learn_covariance(step.drift, mu / scale, 1.0 - mu, state.P[j]);
  make_usable(state.P[j]);
  learn_cross(sensor, j, step, state);
}

/// Updates the shared theta with a measurement. `mu`: probabilities that the modes produced the measurement.
template <int N, int NY, class Sensor>
void learn_together(const Sensor& sensor, const Eigen::VectorXd& mu, double scale, FilterStep<N, NY>& step,
                    DriftState& state) {
  DriftWorkspace<N, NY>& at = step.drift;
  at.together.setZero();
  for (std::size_t j = 0; j < state.cross.size(); ++j) {
    match(sensor, j, step);
    at.together += mu(static_cast<Eigen::Index>(j)) * at.move;
  }
  if (!at.together.allFinite()) {
    for (std::size_t j = 0; j < state.cross.size(); ++j) state.cross[j] = at.cross[j];
    return;
  }
  state.theta.col(0) += at.together;
  for (std::size_t j = 0; j < state.cross.size(); ++j) {
    match(sensor, j, step);
    at.move -= at.together;
    learn_covariance(at, mu(static_cast<Eigen::Index>(j)) / scale, 1.0, state.P[0]);
    learn_cross(sensor, j, step, state);
  }
  make_usable(state.P[0]);
}

/// Updates every mode's theta, weighted with the mode's probability. Call after Bayes' rule.
template <int N, int NY, class Sensor>
void learn(const FilterModel<N, NY>& model, const Sensor& sensor, double scale, FilterStep<N, NY>& step,
           FilterState<N>& state) {
  if (model.drift.shared)
    learn_together(sensor, state.mode_probability, scale, step, state.drift);
  else
    for (std::size_t j = 0; j < model.modes.size(); ++j)
      learn_mode(sensor, j, model.mode_count() == 1 ? 1.0 : state.mode_probability(static_cast<Eigen::Index>(j)), scale,
                 step, state.drift);
  pass_time(model.drift, state.drift);
}

}  // namespace modebank::drift
