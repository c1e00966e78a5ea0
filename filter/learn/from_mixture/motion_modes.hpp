#pragma once

#include <Eigen/Core>
#include <vector>

#include "filter/learn/from_mixture/pooled_modes.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// One mode of a motion model: its own parameters, and a ModeEstimate of its linearisation. theta is the vec of [A B c]
/// at the mode's weighted mean state and input. Standard errors are propagated by the derivative.
struct MotionMode {
  Eigen::VectorXd theta;           ///< p_motion
  Eigen::VectorXd standard_error;  ///< p_motion
  Eigen::MatrixXd by_motion;       ///< derivative of the linear theta by the motion model's theta
  ModeEstimate linear;
};

/// fit_weighted_mode for motion models: weighted least squares of the one-step residuals and the prior. The fit
/// alternates with updates of the residual variances. `weights`: one per training transition. `given`: a fixed theta
/// that is only assessed; null to estimate theta. Q is the weighted scatter / sum of weights, with the floor of a
/// linear mode.
MotionMode fit_motion_mode(const Recording& recording, const MotionModel& model, const Eigen::VectorXd& weights,
                           const GlobalModel& global, const ParameterPrior* prior, const Eigen::VectorXd* given);

/// Fits one mode per column of `memberships`, in parallel.
std::vector<MotionMode> fit_motion_modes(const Recording& recording, const MotionModel& model,
                                         const Eigen::MatrixXd& memberships, const GlobalModel& global,
                                         const ParameterPrior* prior);

}  // namespace modebank
