#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "ident/model/motion_model.hpp"
#include "modebank/base/error.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"

namespace modebank::models {

/// Kinematics of a skid-steer vehicle by instantaneous centres of rotation, with x forward and y to the left (Martinez
/// et al. 2005, eq. 3-8; steering efficiencies a_l, a_r: Mandow et al. 2007, eq. 6-8). In the body frame the left track
/// rotates about (x_v, y_l) and the right one about (x_v, y_r). With the tracks' speeds v_l and v_r:
///   w = (a_r v_r - a_l v_l) / (y_l - y_r),   v_x = a_l v_l + y_l w,   v_y = -x_v w.
/// The velocity follows the wheels without delay: x[k+1] = f(u[k]). States: v_x and yaw rate w.
struct IcrModel {
  double wheel_radius_m = 1.0;

  template <class T>
  void operator()(const T* theta, const T*, const T* u, double, T* next) const {
    const T left = theta[2] * (wheel_radius_m * u[0]), right = theta[3] * (wheel_radius_m * u[1]);
    next[1] = (right - left) / (theta[0] - theta[1]);
    next[0] = left + theta[0] * next[1];
  }
};

/// IcrModel with measured lateral speed: states v_x, v_y, w.
struct LateralIcrModel {
  IcrModel planar;

  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double dt_s, T* next) const {
    T forward_and_yaw[2];
    planar(theta, x, u, dt_s, forward_and_yaw);
    next[0] = forward_and_yaw[0];
    next[1] = -theta[4] * forward_and_yaw[1];
    next[2] = forward_and_yaw[1];
  }
};

/// IcrModel with the yaw rate as its only state. Its parameter is the distance y_l - y_r of the two centres.
struct YawIcrModel {
  double wheel_radius_m = 1.0;

  template <class T>
  void operator()(const T* theta, const T*, const T* u, double, T* next) const {
    next[0] = wheel_radius_m * (u[1] - u[0]) / theta[0];
  }
};

inline std::shared_ptr<const MotionModel> make_icr(const ModelSettings& s) {
  std::vector<ModelParameter> planar{{"icr_left_m", "m", 0.5, 0.02, 100.0},
                                     {"icr_right_m", "m", -0.5, -100.0, -0.02},
                                     {"efficiency_left", "1", 1.0, 0.0, 5.0},
                                     {"efficiency_right", "1", 1.0, 0.0, 5.0}};
  if (s.inputs == 2 && s.states == 1)
    return make_auto_diff_model<1, 2, 1>(YawIcrModel{s.wheel_radius_m}, "icr",
                                         {{"icr_distance_m", "m", 1.0, 0.02, 200.0}});
  if (s.inputs == 2 && s.states == 2)
    return make_auto_diff_model<2, 2, 4>(IcrModel{s.wheel_radius_m}, "icr", std::move(planar));
  planar.push_back({"icr_forward_m", "m", 0.0, -100.0, 100.0});
  if (s.inputs == 2 && s.states == 3)
    return make_auto_diff_model<3, 2, 5>(LateralIcrModel{{s.wheel_radius_m}}, "icr", std::move(planar));
  throw ConfigurationError(
      "model = icr needs the inputs left and right wheel speed, and the states yaw rate; forward speed and yaw "
      "rate; or forward speed, lateral speed and yaw rate, in this order");
}

}  // namespace modebank::models
