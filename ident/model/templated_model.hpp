#pragma once

#include <ceres/jet.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "ident/model/motion_model.hpp"

namespace modebank {

/// A MotionModel from an equation that is written once for any scalar. `Equation` has
///   static constexpr int states, inputs, parameters;
///   std::string name() const;
///   std::vector<ModelParameter> table() const;                      // `parameters` entries
///   template <class T> void predict(const T* theta, const T* x, const T* u, double dt_s, T* next) const;
/// Derivatives are those of Ceres' dual numbers.
template <class Equation>
class TemplatedModel final : public MotionModel {
 public:
  explicit TemplatedModel(Equation equation)
      : equation_(std::move(equation)), name_(equation_.name()), table_(equation_.table()) {}

  const std::string& name() const override { return name_; }
  Eigen::Index states() const override { return N; }
  Eigen::Index inputs() const override { return M; }
  const std::vector<ModelParameter>& parameters() const override { return table_; }

  void predict(const double* theta, const double* x, const double* u, double dt_s, double* next, double* by_theta,
               double* by_x, double* by_u) const override {
    if (by_x || by_u)
      differentiate<P + N + M>(theta, x, u, dt_s, next, {by_theta, by_x, by_u});
    else if (by_theta)
      differentiate<P>(theta, x, u, dt_s, next, {by_theta, nullptr, nullptr});
    else
      equation_.template predict<double>(theta, x, u, dt_s, next);
  }

  /// The same without a call of an unknown function per transition, nor theta made dual in each.
  void residuals(const double* theta, const Transition* transitions, Eigen::Index count, double* r,
                 double* by_theta) const override {
    if (by_theta) return residuals_with_derivatives(theta, transitions, count, r, by_theta);
    for (Eigen::Index k = 0; k < count; ++k, r += N) {
      const Transition& t = transitions[k];
      equation_.template predict<double>(theta, t.x, t.u, t.dt_s, r);
      for (int i = 0; i < N; ++i) r[i] = t.next[i] - r[i];
    }
  }

 private:
  static constexpr int N = Equation::states, M = Equation::inputs, P = Equation::parameters;

  Equation equation_;
  std::string name_;
  std::vector<ModelParameter> table_;

  void residuals_with_derivatives(const double* theta, const Transition* transitions, Eigen::Index count, double* r,
                                  double* by_theta) const {
    using Jet = ceres::Jet<double, P>;
    std::array<Jet, P> dual_theta;
    std::array<Jet, N> x, next;
    std::array<Jet, M> u;
    for (int j = 0; j < P; ++j) dual_theta[j] = Jet(theta[j], j);
    for (Eigen::Index k = 0; k < count; ++k, r += N) {
      const Transition& t = transitions[k];
      for (int i = 0; i < N; ++i) x[i].a = t.x[i];
      for (int i = 0; i < M; ++i) u[i].a = t.u[i];
      equation_.template predict<Jet>(dual_theta.data(), x.data(), u.data(), t.dt_s, next.data());
      for (int i = 0; i < N; ++i) {
        r[i] = t.next[i] - next[i].a;
        for (int j = 0; j < P; ++j) *by_theta++ = next[i].v[j];
      }
    }
  }

  /// Values as dual numbers; the first `Directions` of theta, x, u one after the other are differentiated.
  template <int Directions>
  void differentiate(const double* theta, const double* x, const double* u, double dt_s, double* next,
                     std::array<double*, 3> jacobians) const {
    using Jet = ceres::Jet<double, Directions>;
    std::array<Jet, P + N + M> arguments;
    for (int i = 0; i < P + N + M; ++i) {
      const double value = i < P ? theta[i] : i < P + N ? x[i - P] : u[i - P - N];
      arguments[i] = i < Directions ? Jet(value, i) : Jet(value);
    }
    std::array<Jet, N> result;
    equation_.template predict<Jet>(arguments.data(), arguments.data() + P, arguments.data() + P + N, dt_s,
                                    result.data());
    constexpr std::array<int, 3> first{0, P, P + N}, count{P, N, M};
    for (int i = 0; i < N; ++i) {
      next[i] = result[i].a;
      for (std::size_t part = 0; part < 3; ++part)
        if (jacobians[part])
          for (int j = 0; j < count[part]; ++j) jacobians[part][i * count[part] + j] = result[i].v[first[part] + j];
    }
  }
};

template <class Equation>
std::shared_ptr<const MotionModel> make_templated_model(Equation equation) {
  return std::make_shared<TemplatedModel<Equation>>(std::move(equation));
}

}  // namespace modebank
