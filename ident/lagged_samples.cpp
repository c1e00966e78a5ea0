#include "ident/lagged_samples.hpp"

namespace modebank {

namespace {

/// Regressors of every transition, q x (N - 1).
Eigen::MatrixXd all_regressors(const LinearStructure& structure, const Trajectory& run) {
  Eigen::MatrixXd phi(structure.regressors(), run.transitions());
  for (Index k = 0; k < run.transitions(); ++k) fill_regressor(structure, run, k, phi.col(k));
  return phi;
}

}  // namespace

Eigen::MatrixXd stacked_states(const LinearStructure& structure, const Trajectory& run) {
  LinearStructure states_only = structure;
  states_only.inputs = 0;
  states_only.input_lags = 0;
  states_only.intercept = false;
  Eigen::MatrixXd z(structure.dimension(), run.samples());
  for (Index k = 0; k < run.samples(); ++k) fill_regressor(states_only, run, k, z.col(k));
  return z;
}

Eigen::MatrixXd acting_inputs(const LinearStructure& structure, const Trajectory& run) {
  return all_regressors(structure, run).middleRows(structure.dimension(), structure.acting_inputs());
}

}  // namespace modebank
