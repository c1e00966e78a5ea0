#pragma once

#include <Eigen/Core>

#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// State and input at which a motion model is linearised.
struct OperatingPoint {
  Eigen::VectorXd state;
  Eigen::VectorXd input;
  double dt_s = 0.0;
};

/// Weighted mean state and input of the training runs' finite transitions, and the median sample period. If `weights`
/// is empty, all weights are one.
OperatingPoint operating_point(const Recording& recording, const Eigen::VectorXd& weights = {});

/// First-order approximation x[k+1] = x + A x + B u + c of a motion model about an operating point. It is exact for
/// models that are linear in x and u. `theta` is the vec of [A B c]. `by_motion` is the derivative of `theta` by the
/// model's own parameters, from central differences.
struct LinearisedMotion {
  Eigen::VectorXd theta;
  Eigen::MatrixXd by_motion;
};
LinearisedMotion linearise(const MotionModel& model, const Eigen::VectorXd& theta, const OperatingPoint& at);

/// The global model in linear form. The derivative of the linearisation propagates its covariance.
GlobalModel linearise(const MotionModel& model, const GlobalModel& global, const OperatingPoint& at);

/// The global model of windows in linear form. `motion` is the model of the windows; null for linear models.
GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const MotionModel* motion);

}  // namespace modebank
