#pragma once

#include <Eigen/Core>
#include <iterator>

#include "filter/step/bank_filter.hpp"
#include "filter/step/equations/imm.hpp"

/// A state of the equations as what any filter remembers, and back.
namespace modebank {

template <int N>
void save(const FilterState<N>& state, FilterMemory& memory) {
  const Eigen::Index n = state.modes.front().mean.size(), K = std::ssize(state.modes);
  memory.means.resize(n, K);
  memory.covariances.resize(n * n, K);
  for (Eigen::Index j = 0; j < K; ++j) {
    memory.means.col(j) = state.modes[static_cast<std::size_t>(j)].mean;
    memory.covariances.col(j) = state.modes[static_cast<std::size_t>(j)].covariance.reshaped();
  }
  memory.mode_probability = state.mode_probability;
  memory.noise_scale = state.noise_scale;
  memory.noise_samples = state.noise_samples;
  memory.drift = state.drift;
}

/// `state`: of the memory's sizes.
template <int N>
void restore(const FilterMemory& memory, FilterState<N>& state) {
  const Eigen::Index n = memory.means.rows();
  for (Eigen::Index j = 0; j < memory.means.cols(); ++j) {
    Gaussian<N>& mode = state.modes[static_cast<std::size_t>(j)];
    mode.mean = memory.means.col(j);
    mode.covariance = memory.covariances.col(j).reshaped(n, n);
  }
  state.mode_probability = memory.mode_probability;
  state.noise_scale = memory.noise_scale;
  state.noise_samples = memory.noise_samples;
  state.drift = memory.drift;
}

}  // namespace modebank
