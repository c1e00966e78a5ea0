#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// The decay of one eigenvalue of I + A.
struct Decay {
  double per_sample = 0.0;  ///< share left after one sample: the eigenvalue, or the modulus of a complex pair
  double time_constant_s =
      0.0;  ///< -dt / log |lambda|; infinite for an integrator, negative for growth; 0: decays at once
  double frequency_hz = 0.0;           ///< |arg lambda| / (2 pi dt); half the sample rate for a negative real lambda
  double time_constant_error_s = 0.0;  ///< standard error; NaN if unknown
};

/// The response of a mode to a step of its inputs.
struct ModeDynamics {
  std::vector<Decay> decays;  ///< one per eigenvalue or conjugate pair, slowest first
  Eigen::MatrixXd gain;  ///< n_y x recorded inputs: C (-A)^-1 B for a constant input; NaN if the mode integrates or
                         ///< grows and never settles
  Eigen::MatrixXd gain_error;  ///< standard errors of the gains; NaN if unknown
};

/// Lagged models use the companion form; their gain assumes that the input is constant over all lags. The delta method
/// gives the standard errors from those of the mode's theta and the correlations of its spread. In a refined bank both
/// come from one covariance. In other banks, the windows' correlations stand in for those of their mean.
ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode);

/// Numbers that follow from a mode's model, with standard errors by the delta method. A standard error is NaN if it is
/// unknown, or if a small step of theta changes the count of numbers.
struct DerivedNumbers {
  Eigen::VectorXd values, errors;
};
DerivedNumbers derived_numbers(const Bank& bank, Eigen::Index mode,
                               const std::function<Eigen::VectorXd(const LinearModel&)>& numbers);

}  // namespace modebank
