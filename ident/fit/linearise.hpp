#pragma once

#include <Eigen/Core>

#include "ident/data/trajectory.hpp"
#include "ident/model/local_model.hpp"
#include "ident/model/motion_model.hpp"

namespace modebank {

/// Where a motion model is linearised.
struct OperatingPoint {
  Eigen::VectorXd state;
  Eigen::VectorXd input;
  double dt_s = 0.0;
};

/// Mean state and input of the training runs' finite transitions, each with its weight (`weights` empty: all one), and
/// the median sample period.
OperatingPoint operating_point(const Recording& recording, const Eigen::VectorXd& weights = {});

/// A motion model as x[k+1] = x + A x + B u + c, first order in x and u about an operating point; exact for models that
/// are linear in them. theta is the vec of [A B c]; by_motion its derivative by the model's own parameters, by central
/// differences.
struct LinearisedMotion {
  Eigen::VectorXd theta;
  Eigen::MatrixXd by_motion;
};
LinearisedMotion linearise(const MotionModel& model, const Eigen::VectorXd& theta, const OperatingPoint& at);

/// The global model in linear terms, its covariance carried over by the derivative.
GlobalModel linearise(const MotionModel& model, const GlobalModel& global, const OperatingPoint& at);

/// The global model of windows in linear terms. `motion`: what they were fitted with; null for linear models.
GlobalModel linear_global(const Recording& recording, const WindowFits& windows, const MotionModel* motion);

}  // namespace modebank
