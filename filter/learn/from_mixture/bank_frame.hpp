#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "filter/step/bank.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/learn/options.hpp"

namespace modebank {

/// A bank without modes: structure, measurement, names and sample period of the training data. C = [I 0] selects the
/// newest sample of z; the quanta are those of the recording; R is given, and at least the variance of rounding. A
/// lagged state is called "wz[k-1]". Throws std::invalid_argument unless R has one row per measured state and the
/// structure has the states and inputs of the recording.
Bank bank_frame(const Recording& recording, const LinearStructure& structure, const Eigen::MatrixXd& R);

/// The stated R, if options.measurement_variance is set; otherwise `R`.
Eigen::MatrixXd stated_or(const BankOptions& options, const Eigen::MatrixXd& R);

/// Names of a bank's states and inputs, from the recording's columns.
std::vector<std::string> state_names(const Recording& recording, const LinearStructure& structure);
std::vector<std::string> input_names(const Recording& recording, const LinearStructure& structure);

/// The mode with theta and process noise `Q` of the measured states; lagged samples have no noise.
Mode make_mode(const LinearStructure& structure, const Eigen::VectorXd& theta, const Eigen::MatrixXd& Q,
               const Eigen::MatrixXd& parameter_covariance, const Eigen::VectorXd& standard_error, double weight);

/// Removes the standard errors of parameters that the training runs do not determine. The covariance of the global
/// model has missing values for these parameters. A prior does not change this.
void clear_unidentifiable(Bank& bank, const Eigen::MatrixXd& global_covariance);

/// Sets the transition matrix, with uniform initial probabilities.
void set_mode_sequence(Bank& bank, const TransitionMatrix& transition);

}  // namespace modebank
