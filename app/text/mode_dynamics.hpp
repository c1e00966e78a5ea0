#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "filter/step/bank.hpp"

namespace modebank {

/// How fast one eigenvalue of I + A dies out.
struct Decay {
  double per_sample = 0.0;       ///< what is left of it after a sample: the eigenvalue; of a conjugate pair its size
  double time_constant_s = 0.0;  ///< -dt / log |lambda|; infinite for an integrator, negative when it grows; 0: at once
  double frequency_hz = 0.0;     ///< |arg lambda| / (2 pi dt); half the sample rate for a negative real lambda
  double time_constant_error_s = 0.0;  ///< standard error; NaN where it is not known
};

/// What a mode means to who looks at a step response.
struct ModeDynamics {
  std::vector<Decay> decays;   ///< one per eigenvalue or conjugate pair, slowest first
  Eigen::MatrixXd gain;        ///< n_y x recorded inputs: C (-A)^-1 B of a constant input; NaN of a mode that
                               ///< integrates or grows: an input that is held never settles
  Eigen::MatrixXd gain_error;  ///< standard errors of the same; NaN where they are not known
};

/// With lags the state is the companion form's and the gain is that of an input held over all its lags. Standard errors
/// by the delta method from the mode's standard errors of theta, with the correlations of its spread (of refined banks
/// the two are one covariance; of others the windows' correlations stand in for those of their mean).
ModeDynamics mode_dynamics(const Bank& bank, Eigen::Index mode);

/// What follows from a mode's model, and its standard errors by the same delta method: NaN where they are not known,
/// which is so, too, where a small step of theta changes how many numbers there are.
struct DerivedNumbers {
  Eigen::VectorXd values, errors;
};
DerivedNumbers derived_numbers(const Bank& bank, Eigen::Index mode,
                               const std::function<Eigen::VectorXd(const LinearModel&)>& numbers);

}  // namespace modebank
