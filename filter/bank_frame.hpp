#pragma once

#include <Eigen/Core>

#include "filter/bank.hpp"
#include "ident/trajectory.hpp"

namespace modebank {

/// A bank without modes: structure, measurement (C = I, the given R), names and sample period of the training data.
/// Throws std::invalid_argument when R is not n x n or the structure is not the recording's.
Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// Sets how the modes follow each other, with uniform initial probabilities.
void set_mode_sequence(Bank& bank, const TransitionMatrix& transition);

}  // namespace modebank
