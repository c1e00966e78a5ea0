#pragma once

#include <cmath>
#include <memory>

#include "ident/model/motion_model.hpp"
#include "modebank/base/error.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"

namespace modebank::models {

/// First-order slip model of a skid-steer vehicle. The tracks run at v_l = r u_l and v_r = r u_r (r: wheel radius, u:
/// wheel speeds) and lose the shares s_l and s_r to slip. The body follows with time constant tau (slip ratio: Wong
/// 2008, chapter 6; effective track: Mandow et al. 2007, section III):
///   v_ss = [(1 - s_l) v_l + (1 - s_r) v_r] / 2,   w_ss = [(1 - s_r) v_r - (1 - s_l) v_l] / W,
///   x[k+1] = x[k] + (1 - exp(-dt / tau)) (x_ss - x[k])    (exact for inputs held over the step).
/// States: forward speed and yaw rate (m/s, rad/s). Left turns and forward motion are positive.
struct SlipModel {
  double wheel_radius_m = 1.0;

  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double dt_s, T* next) const {
    using std::exp;
    const T left = (1.0 - theta[1]) * (wheel_radius_m * u[0]), right = (1.0 - theta[2]) * (wheel_radius_m * u[1]);
    const T gain = 1.0 - exp(-dt_s / theta[3]);
    next[0] = x[0] + gain * (0.5 * (left + right) - x[0]);
    next[1] = x[1] + gain * ((right - left) / theta[0] - x[1]);
  }
};

/// SlipModel with the yaw rate as its only state. Yaw rate alone cannot separate slip common to both sides from a wider
/// track, so W is the track that explains the mean gain. The additional loss of the left side is slip_difference d:
///   w_ss = [(1 + d/2) v_r - (1 - d/2) v_l] / W.
struct YawSlipModel {
  double wheel_radius_m = 1.0;

  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double dt_s, T* next) const {
    using std::exp;
    const T left = (1.0 - 0.5 * theta[1]) * (wheel_radius_m * u[0]),
            right = (1.0 + 0.5 * theta[1]) * (wheel_radius_m * u[1]);
    next[0] = x[0] + (1.0 - exp(-dt_s / theta[2])) * ((right - left) / theta[0] - x[0]);
  }
};

inline std::shared_ptr<const MotionModel> make_slip(const ModelSettings& s) {
  const ModelParameter track{"effective_track_m", "m", 1.0, 0.05, 100.0};
  const ModelParameter time_constant{"time_constant_s", "s", 0.2, 1e-4, 100.0};
  if (s.inputs == 2 && s.states == 1)
    return make_auto_diff_model<1, 2, 3>(YawSlipModel{s.wheel_radius_m}, "slip",
                                         {track, {"slip_difference", "1", 0.0, -2.0, 2.0}, time_constant});
  if (s.inputs == 2 && s.states == 2)
    return make_auto_diff_model<2, 2, 4>(
        SlipModel{s.wheel_radius_m}, "slip",
        {track, {"slip_left", "1", 0.1, -5.0, 1.0}, {"slip_right", "1", 0.1, -5.0, 1.0}, time_constant});
  throw ConfigurationError(
      "model = slip needs the inputs left and right wheel speed, and the states yaw rate, or forward speed and "
      "yaw rate, in this order");
}

}  // namespace modebank::models
