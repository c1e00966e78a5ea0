#pragma once
#include "ident/model/motion_model.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"
namespace modebank::models {
struct DecayModel {  // a speed that decays toward gain * u
  template <class T>
  void operator()(const T* theta, const T* x, const T* u, double dt_s, T* next) const {
    using std::exp;
    next[0] = x[0] + (1.0 - exp(-dt_s / theta[0])) * (theta[1] * u[0] - x[0]);
  }
};
inline std::shared_ptr<const MotionModel> make_decay(const ModelSettings&) {
  return make_auto_diff_model<1, 1, 2>(DecayModel(), "decay",  // states, inputs, parameters
                                       {{"time_constant_s", "s", 0.5, 1e-3, 100.0}, {"gain", "1", 1.0}});
}
}  // namespace modebank::models
