#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// The rows of one training run in TrainingTransitions.
struct RunRows {
  Index run = 0;               ///< index in Recording::runs
  Index first = 0, count = 0;  ///< row of the run's transition 0, and number of transitions
};

/// All transitions of the training runs, run by run. A transition with a missing (non-finite) sample keeps its row,
/// with zeros, so that positions match the run.
struct TrainingTransitions {
  LinearStructure structure;
  Transitions data;           ///< N rows
  Eigen::VectorXd usable;     ///< N, 1 where the row is usable, otherwise 0
  std::vector<RunRows> runs;  ///< training runs, in the order of the recording

  Index count() const { return data.count(); }
};

/// Throws std::invalid_argument if states and inputs of the structure differ from those of the recording.
void check_structure(const Recording& recording, const LinearStructure& structure);

/// Throws DataError without `any` transition of a training run.
void require_transitions(bool any);

/// Collects the training transitions. Throws the errors of check_structure, and DataError without a usable transition.
TrainingTransitions gather_training_transitions(const Recording& recording, const LinearStructure& structure);

/// Sums over the rows of each run. `rows`: N values.
Eigen::VectorXd sum_by_run(const TrainingTransitions& transitions, const Eigen::VectorXd& rows);

/// Sums over transitions for a regression, with weights g. r is the residual (increment minus prediction) with the
/// coefficients about which the sums were taken.
struct RegressionSums {
  Eigen::MatrixXd G;    ///< q x q, the sum of g phi phi'
  Eigen::MatrixXd H;    ///< q x n, the sum of g phi r'
  Eigen::MatrixXd S;    ///< n x n, the sum of g r r'
  double weight = 0.0;  ///< sum of g, the number of effective transitions

  RegressionSums operator+(const RegressionSums& other) const;
  /// The sum of g r r' after `change` (q x n) is added to the coefficients about which the sums were taken.
  Eigen::MatrixXd scatter_after(const Eigen::MatrixXd& change) const;
};

/// `weights`: N; `residuals`: N x n.
RegressionSums regression_sums(const Eigen::MatrixXd& regressors, const Eigen::VectorXd& weights,
                               const Eigen::MatrixXd& residuals);

/// theta as the q x n coefficients of increments = regressors * coefficients, the transpose of [A B (c)].
inline Eigen::MatrixXd coefficients(const LinearStructure& s, const Eigen::VectorXd& theta) {
  return theta.reshaped(s.regressors(), s.states);
}

/// A copy of the recording with the training runs only.
Recording training_part(const Recording& recording);

}  // namespace modebank
