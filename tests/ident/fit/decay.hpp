#pragma once
#include "ident/model/templated_model.hpp"
namespace modebank::models {
struct DecayModel {  // a speed that decays toward gain * u
  static constexpr int states = 1, inputs = 1, parameters = 2;
  std::string name() const { return "decay"; }
  std::vector<ModelParameter> table() const {  // name, unit, start, bounds
    return {{"time_constant_s", "s", 0.5, 1e-3, 100.0}, {"gain", "1", 1.0}};
  }
  template <class T>
  void predict(const T* theta, const T* x, const T* u, double dt_s, T* next) const {
    using std::exp;
    next[0] = x[0] + (1.0 - exp(-dt_s / theta[0])) * (theta[1] * u[0] - x[0]);
  }
};
inline std::shared_ptr<const MotionModel> make_decay(const ModelSettings&) {
  return make_templated_model(DecayModel());
}
}  // namespace modebank::models
