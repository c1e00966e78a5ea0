#pragma once

#include <Eigen/Core>

#include "filter/step/equations/imm.hpp"

/// The filter as published in Salvi et al. (2025), arXiv 2505.00200, eq. 12-18, for comparison with the paper. This
/// header contains the differences from the IMM (imm.hpp).
namespace modebank::salvi2025 {

/// Weights w(k-1)_i T_ij of [S25, eq. 12-13]. Their sum is below one, so mixed states shrink towards zero.
inline void mixing_weights(const TransitionMatrix& transition, const Eigen::VectorXd& w, MixingWeights& weights) {
  weights.matrix.noalias() = w.asDiagonal() * transition.matrix();
}

/// The modes' probabilities from log L_j = log N(C xhat_j - z; 0, S_j). As published in [S25, eq. 16], the residual is
/// that after the update.
template <int N, int NY, class Sensor, class Y>
void weigh_by_posterior(const Sensor& sensor, const Y& z, FilterStep<N, NY>& step, FilterState<N>& state) {
  for (std::size_t j = 0; j < state.modes.size(); ++j) {
    small::multiply(step.residual, sensor.C, state.modes[j].mean);
    step.residual -= z;
    step.log_likelihood(static_cast<Eigen::Index>(j)) = step.kalman[j].log_normal(step.residual);
  }
  bayes(step.predicted_probability, step.log_likelihood, state.mode_probability);
}

}  // namespace modebank::salvi2025
