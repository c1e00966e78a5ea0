#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "modebank/base/dual.hpp"
#include "modebank/ident/motion_model.hpp"

namespace modebank {

/// A MotionModel of N states, M inputs and P parameters from one equation for any scalar type, like in Ceres'
/// AutoDiffCostFunction. `Functor` has  `template <class T> void operator()(const T* theta, const T* x, const T* u,
/// double dt_s, T* next) const`. It fills `next` (N). It calls exp and other functions unqualified, after `using
/// std::exp`. Derivatives come from Dual numbers.
template <class Functor, int N, int M, int P>
class AutoDiffMotionModel final : public MotionModel {
 public:
  /// `name`: model name in results. `parameters`: must have P entries; throws std::invalid_argument for another number.
  AutoDiffMotionModel(Functor functor, std::string name, std::vector<ModelParameter> parameters)
      : functor_(std::move(functor)), name_(std::move(name)), parameters_(std::move(parameters)) {
    if (parameters_.size() != P)
      throw std::invalid_argument("parameters: model " + name_ + " has " + std::to_string(P) + ", not " +
                                  std::to_string(parameters_.size()));
  }

  /// Name of the model.
  const std::string& name() const override { return name_; }
  /// Number of states N.
  std::ptrdiff_t states() const override { return N; }
  /// Number of inputs M.
  std::ptrdiff_t inputs() const override { return M; }
  /// The P parameters.
  const std::vector<ModelParameter>& parameters() const override { return parameters_; }

  /// One-step prediction; computes only the requested derivatives.
  void predict(const double* theta, const double* x, const double* u, double dt_s, double* next,
               double* by_theta = nullptr, double* by_x = nullptr, double* by_u = nullptr) const override {
    if (by_x || by_u)
      differentiate<P + N + M>(theta, x, u, dt_s, next, {by_theta, by_x, by_u});
    else if (by_theta)
      differentiate<P>(theta, x, u, dt_s, next, {by_theta, nullptr, nullptr});
    else
      functor_(theta, x, u, dt_s, next);
  }

  /// Residuals of many transitions. For all of them together, needs only one virtual call and one conversion of theta
  /// to dual numbers.
  void residuals(const double* theta, const Transition* transitions, std::ptrdiff_t count, double* r,
                 double* by_theta) const override {
    if (by_theta) return residuals_with_derivatives(theta, transitions, count, r, by_theta);
    for (std::ptrdiff_t k = 0; k < count; ++k, r += N) {
      const Transition& t = transitions[k];
      functor_(theta, t.x, t.u, t.dt_s, r);
      for (int i = 0; i < N; ++i) r[i] = t.next[i] - r[i];
    }
  }

 private:
  Functor functor_;
  std::string name_;
  std::vector<ModelParameter> parameters_;

  template <class T>
  static void copy(const double* from, std::size_t count, T* to) {
    for (std::size_t i = 0; i < count; ++i) to[i] = T(from[i]);
  }

  void residuals_with_derivatives(const double* theta, const Transition* transitions, std::ptrdiff_t count, double* r,
                                  double* by_theta) const {
    using Number = Dual<P>;
    std::array<Number, P> dual_theta;
    std::array<Number, N> x, next;
    std::array<Number, M> u;
    for (int j = 0; j < P; ++j) dual_theta[static_cast<std::size_t>(j)] = Number(theta[j], j);
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const Transition& t = transitions[k];
      copy(t.x, N, x.data());
      copy(t.u, M, u.data());
      functor_(static_cast<const Number*>(dual_theta.data()), static_cast<const Number*>(x.data()),
               static_cast<const Number*>(u.data()), t.dt_s, next.data());
      for (std::size_t i = 0; i < N; ++i) {
        *r++ = t.next[i] - next[i].value;
        for (const double slope : next[i].slope) *by_theta++ = slope;
      }
    }
  }

  /// Values as dual numbers. The derivatives are with respect to the first `Directions` entries of theta, x and u
  /// (concatenated).
  template <int Directions>
  void differentiate(const double* theta, const double* x, const double* u, double dt_s, double* next,
                     std::array<double*, 3> jacobians) const {
    using Number = Dual<Directions>;
    std::array<Number, P + N + M> arguments;
    for (int i = 0; i < P + N + M; ++i) {
      const double value = i < P ? theta[i] : i < P + N ? x[i - P] : u[i - P - N];
      arguments[static_cast<std::size_t>(i)] = i < Directions ? Number(value, i) : Number(value);
    }
    std::array<Number, N> result;
    const Number* const first_argument = arguments.data();
    functor_(first_argument, first_argument + P, first_argument + P + N, dt_s, result.data());
    constexpr std::array<int, 3> first{0, P, P + N}, count{P, N, M};
    for (int i = 0; i < N; ++i) {
      const Number& of_state = result[static_cast<std::size_t>(i)];
      next[i] = of_state.value;
      for (std::size_t part = 0; part < 3; ++part)
        if (jacobians[part])
          for (int j = 0; j < count[part]; ++j)
            jacobians[part][i * count[part] + j] = of_state.slope[static_cast<std::size_t>(first[part] + j)];
    }
  }
};

/// Makes a shared AutoDiffMotionModel<Functor, N, M, P>; the functor's type is deduced.
template <int N, int M, int P, class Functor>
std::shared_ptr<const MotionModel> make_auto_diff_model(Functor functor, std::string name,
                                                        std::vector<ModelParameter> parameters) {
  return std::make_shared<AutoDiffMotionModel<Functor, N, M, P>>(std::move(functor), std::move(name),
                                                                 std::move(parameters));
}

}  // namespace modebank
