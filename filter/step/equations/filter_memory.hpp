#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <iterator>
#include <vector>

#include "filter/step/bank_filter.hpp"
#include "filter/step/equations/imm.hpp"

/// Converts between the state of the equations and the memory that all filters share.
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
}

/// Number of uncertain rows of these estimates. Rows after these have the same mean in all estimates, and zero
/// covariance.
template <int N>
Eigen::Index uncertain_rows_of(const std::vector<Gaussian<N>>& modes) {
  Eigen::Index rows = modes.front().mean.size();
  const auto known = [&](Eigen::Index row) {
    return has_one_mean<N>(modes, row) && std::all_of(modes.begin(), modes.end(), [row](const Gaussian<N>& mode) {
             return (mode.covariance.col(row).array() == 0.0).all();
           });
  };
  while (rows > 0 && known(rows - 1)) --rows;
  return rows;
}

/// `state` must have the sizes of the memory. `exact`: see FilterModel.
template <int N>
void restore(const FilterMemory& memory, bool exact, FilterState<N>& state) {
  const Eigen::Index n = memory.means.rows();
  for (Eigen::Index j = 0; j < memory.means.cols(); ++j) {
    Gaussian<N>& mode = state.modes[static_cast<std::size_t>(j)];
    mode.mean = memory.means.col(j);
    mode.covariance = memory.covariances.col(j).reshaped(n, n);
  }
  const Eigen::Index uncertain = exact ? uncertain_rows_of(state.modes) : n;
  for (Gaussian<N>& mode : state.modes) mode.uncertain = uncertain;
  state.mode_probability = memory.mode_probability;
}

}  // namespace modebank
