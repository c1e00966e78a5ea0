#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/noise_factor.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/linear_model.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

/// The rows of one training run within TrainingTransitions.
struct RunRows {
  Index run = 0;    ///< position in Recording::runs
  Index first = 0;  ///< row of the run's transition 0
  Index count = 0;  ///< transitions of the run
};

/// Every transition of the training runs once, run by run. A transition with a missing (non-finite) sample keeps its
/// row, so that positions stay those of the run, but holds zeros and is not usable; nor is one of sample weight zero.
/// Rows are not multiplied by their sample weights: `usable` carries these.
struct TrainingTransitions {
  LinearStructure structure;
  Transitions data;           ///< N rows
  Eigen::VectorXd usable;     ///< N, 0 or the sample weight (1 without; mean 1 over the usable)
  std::vector<RunRows> runs;  ///< training runs, in the recording's order
  /// N, log of what every row is divided by the root of, which makes the noise of all rows alike; empty: nothing.
  Eigen::VectorXd log_noise_factor = {};

  Index count() const { return data.count(); }
};

/// Throws std::invalid_argument when the structure does not have the recording's states and inputs.
void check_structure(const Recording& recording, const LinearStructure& structure);

/// Throws as check_structure does, and DataError when no training run has a usable transition.
/// `factor`: rows are divided by its root, so that least squares and expectation-maximisation stay as they are.
TrainingTransitions gather_training_transitions(const Recording& recording, const LinearStructure& structure,
                                                const NoiseFactor& factor = {});

/// Divides every row by the root of its noise factor. Returns the factors' logarithms, N; empty without a factor.
Eigen::VectorXd divide_by_noise(const NoiseFactor& factor, const LinearStructure& structure, Transitions& rows);

/// Sums over the rows of each run. `rows`: N.
Eigen::VectorXd sum_by_run(const TrainingTransitions& transitions, const Eigen::VectorXd& rows);

/// What a regression needs to know of weighted transitions: sums over them, r being the residual (increment minus
/// prediction) of whatever coefficients the sums are taken about, g the weight of a transition.
struct RegressionSums {
  Eigen::MatrixXd G;    ///< q x q, sum g phi phi'
  Eigen::MatrixXd H;    ///< q x n, sum g phi r'
  Eigen::MatrixXd S;    ///< n x n, sum g r r'
  double weight = 0.0;  ///< sum g, effective transitions

  RegressionSums operator+(const RegressionSums& other) const;
  /// sum g r r' about coefficients that differ by `change` (q x n).
  Eigen::MatrixXd scatter_after(const Eigen::MatrixXd& change) const;
};

/// `weights`: N; `residuals`: N x n.
RegressionSums regression_sums(const Eigen::MatrixXd& regressors, const Eigen::VectorXd& weights,
                               const Eigen::MatrixXd& residuals);

/// theta as the q x n coefficients of increments = regressors * coefficients: the transpose of [A B (c)].
inline Eigen::MatrixXd coefficients(const LinearStructure& s, const Eigen::VectorXd& theta) {
  return theta.reshaped(s.regressors(), s.states);
}

/// Copy of the recording's channels, and the training runs alone.
Recording training_part(const Recording& recording);
/// The same where every sample counts as much as any other.
Recording unweighted_training_part(const Recording& recording);

}  // namespace modebank
