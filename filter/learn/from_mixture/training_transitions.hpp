#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/model.hpp"
#include "ident/regression.hpp"
#include "ident/trajectory.hpp"

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

  Index count() const { return data.count(); }
};

/// Throws std::invalid_argument when the structure does not have the recording's states and inputs.
void check_structure(const Recording& recording, const LinearStructure& structure);

/// Throws as check_structure does, and DataError when no training run has a usable transition.
TrainingTransitions gather_training_transitions(const Recording& recording, const LinearStructure& structure);

/// theta as the q x n coefficients of increments = regressors * coefficients: the transpose of [A B (c)].
inline Eigen::MatrixXd coefficients(const LinearStructure& s, const Eigen::VectorXd& theta) {
  return theta.reshaped(s.regressors(), s.states);
}

/// Copy of the recording's channels, and the training runs alone.
Recording training_part(const Recording& recording);

}  // namespace modebank
