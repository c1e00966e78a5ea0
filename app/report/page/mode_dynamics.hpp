#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// How fast one eigenvalue of I + A dies out.
struct Decay {
  double time_constant_s = 0.0;  ///< -dt / log |lambda|; infinite for an integrator, negative when it grows; 0: at once
  double frequency_hz = 0.0;     ///< |arg lambda| / (2 pi dt); half the sample rate for a negative real lambda
};

/// What a mode means to who looks at a step response.
struct ModeDynamics {
  std::vector<Decay> decays;  ///< one per eigenvalue or conjugate pair, slowest first
  Eigen::MatrixXd gain;       ///< n_y x recorded inputs: C (-A)^-1 B of a constant input; NaN when A is singular
};

/// With lags the state is the companion form's and the gain is that of an input held over all its lags.
ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode);

}  // namespace modebank
