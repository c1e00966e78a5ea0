#pragma once

#include <Eigen/Core>

#include "filter/imm.hpp"
#include "filter/kalman.hpp"

/// The filter as printed in Salvi et al. (2025), arXiv 2505.00200, eq. 12-18, kept for comparison with the paper.
namespace modebank::salvi2025 {

/// Weights w(k-1)_i T_ij of [S25, eq. 12-13]: not divided by their sum, so mixed states shrink towards zero.
inline void mixing_weights(const TransitionMatrix& transition, const Eigen::VectorXd& w, MixingWeights& weights) {
  weights.matrix.noalias() = w.asDiagonal() * transition.matrix();
}

/// log L_j = log N(C xhat_j - z; 0, S_j) with the residual taken after the update, as printed in [S25, eq. 16].
template <int N, int NY, class Sensor, class Y>
double log_likelihood(const Sensor& sensor, const KalmanStep<N, NY>& step, const Gaussian<N>& posterior, const Y& z,
                      Eigen::Matrix<double, NY, 1>& residual) {
  small::multiply(residual, sensor.C, posterior.mean);
  residual -= z;
  return step.log_normal(residual);
}

}  // namespace modebank::salvi2025
