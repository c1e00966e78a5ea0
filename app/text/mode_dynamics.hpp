#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// The decay that belongs to one eigenvalue of I + A.
struct Decay {
  double per_sample = 0.0;  ///< factor per sample: the eigenvalue, or the modulus of a complex pair
  double time_constant_s =
      0.0;  ///< -dt / log |lambda|; infinite for an integrator, negative for growth, 0 if it decays at once
  double frequency_hz = 0.0;           ///< |arg lambda| / (2 pi dt); for a negative real lambda half the sample rate
  double time_constant_error_s = 0.0;  ///< standard error of time_constant_s; NaN if unknown
};

/// How the state of a mode responds to a step of its inputs.
struct ModeDynamics {
  std::vector<Decay> decays;  ///< one per eigenvalue or conjugate pair, the slowest first
  Eigen::MatrixXd gain;  ///< n_y x recorded inputs: C (-A)^-1 B, the gain at a constant input; NaN if the mode never
                         ///< settles, because it integrates or grows
  Eigen::MatrixXd gain_error;  ///< standard errors of the gains; NaN if unknown
};

/// Lagged models use the companion form. Their gain assumes a constant input over all lags. The delta method gives the
/// standard errors. It uses the standard errors of theta, and correlations from the mode's parameter covariance. In a
/// refined bank, both come from one covariance. In other banks, the correlations over windows replace the correlations
/// of their mean.
ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode);

/// Sets the step responses of modes that have none, with errors by draws from the covariance described above.
void add_responses(Bank& bank);

}  // namespace modebank
