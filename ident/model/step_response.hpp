#pragma once

#include <Eigen/Core>
#include <vector>

#include "ident/base/not_a_number.hpp"
#include "ident/model/linear_model.hpp"

namespace modebank {

/// How the states respond to a unit step of one input at time 0, from rest. Row i, column j: state i, input j. All but
/// `radius` are NaN if the model never settles (radius >= 1), times and overshoot also where the gain is zero.
struct StepResponse {
  Eigen::MatrixXd response_s;  ///< n x m, first time at 1 - 1/e = 63 % of the steady value, dead time included [s]
  Eigen::MatrixXd settling_s;  ///< n x m, time after which the state stays within 5 % of the steady value [s]
  Eigen::MatrixXd gain;        ///< n x m, steady value [state unit per input unit]
  Eigen::MatrixXd overshoot;   ///< n x m, how far the peak exceeds the steady value, as a share of it
  Eigen::MatrixXd radius;      ///< n x m, largest modulus of the poles, the same for all pairs
};

struct EstimatedStepResponse {
  StepResponse value;
  StepResponse error;  ///< half the 16 to 84 % range over draws of theta; infinite if over 16 % of them have no such
                       ///< number, NaN without a covariance
  Eigen::MatrixXd never_settles;  ///< n x m, share of the draws that never settle, the same for all pairs; NaN
                                  ///< without a covariance
};

/// `delay` (m): number of samples from each input to its first effect, used in place of structure.input_delay. A model
/// of differences x[k] - x[k-1] has the response of its coefficients as they are. Errors come from 200 draws of theta
/// from N(theta, covariance) with a fixed seed; the covariance may be singular, and empty if it is unknown.
EstimatedStepResponse step_response(const LinearStructure& structure, const Eigen::VectorXd& theta,
                                    const Eigen::MatrixXd& covariance, const std::vector<Eigen::Index>& delay,
                                    double dt_s);

}  // namespace modebank
