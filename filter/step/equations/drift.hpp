#pragma once

#include <Eigen/Core>

#include "filter/step/equations/imm.hpp"

/// Modes whose coefficients wander within a run, where the state is measured exactly (R = 0). Each mode k keeps its own
/// Gaussian of theta, mean m_k and covariance s P_k, s the noise scale, from theta_k and P0_k at a start; it is never
/// mixed with another mode's. With G the regressors' matrix, x[k+1] = x + G' theta + w,
///   y:  mean of mode k with m_k for theta, S_k = s (Q_k + G_k' P_k G_k);
///   theta, had mode k ruled the step: m_k + g, P_k - D with gain D G.. of the Kalman filter; else as it was; both
///       with their probabilities mu_k and 1 - mu_k after the measurement, matched in mean and covariance:
///       m_k + mu_k g,   P_k - mu_k D + mu_k (1 - mu_k) g g' / s;
///   then time passes: m_k <- theta_k + leak (m_k - theta_k),   P_k <- leak^2 P_k + W_k.
/// Where nothing was measured the state's error is correlated with theta's (`cross`), which predictions several steps
/// ahead take into account to first order: the extended Kalman filter of (theta, x). W = P0 = 0 is the bank that does
/// not drift. One mode of diagonal Q is DriftingRecursion.
namespace modebank::drift {

/// [A B (c)] of a mode from its theta; companion rows stay.
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
  }
}

/// What errors of theta add to the prediction of mode j that was made with its mean; `share`: of the state that the
/// prediction starts from, what is the mode's own.
template <int N, int NY, class U>
void add_errors(const FilterModel<N, NY>& model, const FilterState<N>& state, std::size_t j, double share,
                const Gaussian<N>& from, const U& u, FilterStep<N, NY>& step) {
  const LinearStructure& s = model.structure;
  const Eigen::Index n_s = s.states, n = s.dimension(), r = s.regressors();
  DriftWorkspace<N, NY>& at = step.drift;
  KalmanStep<N, NY>& kalman = step.kalman[j];
  const auto& F = at.modes[j].F;
  fill_regressor(s, from.mean, u, at.regressor);
  for (Eigen::Index a = 0; a < n_s; ++a) {
    at.PG.col(a).noalias() = state.noise_scale * (state.drift.P[j].middleCols(a * r, r) * at.regressor);
    at.through.row(a).noalias() = share * (at.regressor.transpose() * state.drift.cross[j].middleRows(a * r, r));
  }
  small::multiply_transposed(at.cross[j], state.drift.cross[j], F);
  at.cross[j] *= share;
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

/// Step 3 of imm.hpp with the modes' coefficients as they stand.
template <int N, int NY, class U>
void predict_modes(const FilterModel<N, NY>& model, const FilterState<N>& state, const std::vector<Gaussian<N>>& from,
                   const U& u, FilterStep<N, NY>& step) {
  for (std::size_t j = 0; j < model.modes.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    set_coefficients(model.structure, state.drift.theta.col(k), step.drift.modes[j]);
    step.kalman[j].predict(from[j], model, step.drift.modes[j], u, state.noise_scale);
    const double share = model.mode_count() == 1 ? 1.0 : step.mixing.matrix(k, k);
    add_errors(model, state, j, share, from[j], u, step);
    step.kalman[j].expect(model);
  }
}

/// Between two samples: coefficients leak to where they came from, and wander.
inline void pass_time(const DriftModel& model, DriftState& state) {
  if (model.leak != 1.0) state.theta = model.theta0 + model.leak * (state.theta - model.theta0);
  for (std::size_t j = 0; j < state.P.size(); ++j) {
    if (model.leak != 1.0) {
      state.P[j] *= model.leak * model.leak;
      state.cross[j] *= model.leak;
    }
    state.P[j] += model.W[j];
  }
}

/// Nothing was measured: theta is what it was, and the predicted state's error goes with its error.
template <int N, int NY>
void keep_prediction(const FilterModel<N, NY>& model, const FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < state.drift.cross.size(); ++j) state.drift.cross[j] = step.drift.cross[j];
  pass_time(model.drift, state.drift);
}

/// A covariance that rounding made indefinite keeps its variances and loses its correlations.
inline void make_usable(Eigen::MatrixXd& P) {
  if (P.diagonal().minCoeff() >= 0.0) return;
  for (Eigen::Index j = 0; j < P.cols(); ++j)
    for (Eigen::Index i = 0; i < P.rows(); ++i) P(i, j) = i == j ? std::max(0.0, P(i, i)) : 0.0;
}

/// Mode j's theta after a measurement which it made with probability mu; `scale`: of the noise in its prediction.
template <int N, int NY, class Sensor>
void learn_mode(const Sensor& sensor, std::size_t j, double mu, double scale, FilterStep<N, NY>& step,
                DriftState& state) {
  DriftWorkspace<N, NY>& at = step.drift;
  const KalmanStep<N, NY>& kalman = step.kalman[j];
  small::multiply_transposed(at.G, at.cross[j], sensor.C);
  for (Eigen::Index i = 0; i < at.G.rows(); ++i) {
    at.row = at.G.row(i);
    kalman.cholesky.solve(at.row);
    at.gain.row(i) = at.row;
  }
  small::multiply(at.move, at.gain, kalman.innovation);
  state.cross[j] = at.cross[j];
  if (!at.move.allFinite()) return;  // an overflowing correction is no information
  state.theta.col(static_cast<Eigen::Index>(j)) += mu * at.move;
  Eigen::MatrixXd& P = state.P[j];
  for (Eigen::Index b = 0; b < P.cols(); ++b)
    for (Eigen::Index a = b; a < P.rows(); ++a) {
      double known = 0.0;
      for (Eigen::Index i = 0; i < at.G.cols(); ++i) known += at.gain(a, i) * at.G(b, i);
      P(a, b) += mu / scale * ((1.0 - mu) * at.move(a) * at.move(b) - known);
      P(b, a) = P(a, b);
    }
  make_usable(P);
  small::multiply_transposed(at.seen, kalman.predicted.covariance, sensor.C);
  for (Eigen::Index i = 0; i < at.gain.cols(); ++i)
    state.cross[j].noalias() -= at.gain.col(i) * at.seen.col(i).transpose();
}

/// After Bayes' rule: every mode's theta learns by its probability.
template <int N, int NY, class Sensor>
void learn(const FilterModel<N, NY>& model, const Sensor& sensor, double scale, FilterStep<N, NY>& step,
           FilterState<N>& state) {
  for (std::size_t j = 0; j < model.modes.size(); ++j)
    learn_mode(sensor, j, model.mode_count() == 1 ? 1.0 : state.mode_probability(static_cast<Eigen::Index>(j)), scale,
               step, state.drift);
  pass_time(model.drift, state.drift);
}

}  // namespace modebank::drift
