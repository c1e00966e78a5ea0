#pragma once

#include "filter/step/bank.hpp"

namespace modebank::bench {

/// K modes whose parameters are distributed around those of the simulated modes.
inline Bank make_bank(Eigen::Index modes) {
  Bank bank;
  bank.structure = {1, 2, false};
  for (Eigen::Index k = 0; k < modes; ++k) {
    const double t = static_cast<double>(k + 1) / static_cast<double>(modes);
    Mode mode;
    mode.model = {Eigen::MatrixXd::Constant(1, 1, -0.6 * t), Eigen::RowVector2d(-0.7 * t, 0.7 * t),
                  Eigen::VectorXd::Zero(1)};
    mode.Q = Eigen::MatrixXd::Constant(1, 1, 4e-4 * t);
    mode.parameter_covariance = Eigen::MatrixXd::Zero(3, 3);
    mode.standard_error = Eigen::VectorXd::Zero(3);
    mode.weight = 1.0 / static_cast<double>(modes);
    bank.modes.push_back(mode);
  }
  bank.C = Eigen::MatrixXd::Identity(1, 1);
  bank.R = Eigen::MatrixXd::Constant(1, 1, 1e-6);
  bank.transition = TransitionMatrix::sticky(modes, 0.95);
  bank.initial_probability = Eigen::VectorXd::Constant(modes, 1.0 / static_cast<double>(modes));
  bank.state_names = {"wz"};
  bank.input_names = {"velL", "velR"};
  return bank;
}

}  // namespace modebank::bench
