#pragma once

#include <Eigen/Core>
#include <limits>

#include "ident/model.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// The regressors of transition k of a run; entries whose sample lies before the run are NaN.
template <class Phi>
void fill_regressor(const LinearStructure& s, const Trajectory& run, Index k, Phi&& phi) {
  constexpr double outside = std::numeric_limits<double>::quiet_NaN();
  for (Index i = 0; i < s.state_lags; ++i) {
    auto block = phi.segment(i * s.states, s.states);
    if (k - i >= 0)
      block = run.state.col(k - i);
    else
      block.setConstant(outside);
  }
  for (Index j = 0; j < s.input_lags; ++j) {
    auto block = phi.segment(s.dimension() + j * s.inputs, s.inputs);
    const Index sample = k + 1 - s.input_delay - j;
    if (sample >= 0)
      block = run.input.col(sample);
    else
      block.setConstant(outside);
  }
  if (s.intercept) phi(s.regressors() - 1) = 1.0;
}

/// z[k] of every sample, n x N; NaN where a lagged sample lies before the run.
Eigen::MatrixXd stacked_states(const LinearStructure& structure, const Trajectory& run);
/// v[k] of every transition, m x (N - 1); NaN where a sample lies before the run.
Eigen::MatrixXd acting_inputs(const LinearStructure& structure, const Trajectory& run);

}  // namespace modebank
