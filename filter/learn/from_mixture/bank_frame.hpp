#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"

namespace modebank {

/// A bank without modes: structure, measurement (C = [I 0]: the newest sample of z, the given R, the recording's
/// quanta), names and sample period of the training data; a lagged state is called "wz[k-1]". Throws
/// std::invalid_argument when R does not have one row per measured state or the structure is not the recording's.
Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// Names of a bank's states and inputs over the recording's columns.
std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure);
std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure);

/// The mode of theta with the process noise `Q` of the measured states; lagged samples have none.
Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& spread, const Eigen::VectorXd& standard_error, double weight);

/// Takes standard errors from parameters that have none in the global model of the same covariance, where others do: no
/// training run says anything of them, whatever a prior does.
void leave_open(Bank& bank, const Eigen::MatrixXd& global_covariance);

/// Sets how the modes follow each other, with uniform initial probabilities.
void set_mode_sequence(Bank& bank, const TransitionMatrix& transition);

}  // namespace modebank
