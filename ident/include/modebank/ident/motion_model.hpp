#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace modebank {

/// One parameter of a motion model: what it is called, its unit, where a search for it starts and where it may lie.
struct ModelParameter {
  std::string name;                                         ///< as results name it
  std::string unit;                                         ///< may be empty
  double start = 0.0;                                       ///< where searches begin
  double lower = -std::numeric_limits<double>::infinity();  ///< least value
  double upper = std::numeric_limits<double>::infinity();   ///< largest value
};

/// A model of motion with p parameters: a one-step prediction x[k+1] = f(theta, x[k], u[k], dt) of n states from m
/// inputs held over the step. Immutable, shared by threads. A program may bring its own: an AutoDiffMotionModel
/// (auto_diff_motion_model.hpp) of one equation, or a class of its own with derivatives by hand.
class MotionModel {
 public:
  virtual ~MotionModel() = default;
  /// As results name it; none of the names that modebank has.
  virtual const std::string& name() const = 0;
  /// n.
  virtual std::ptrdiff_t states() const = 0;
  /// m.
  virtual std::ptrdiff_t inputs() const = 0;
  /// p of them.
  virtual const std::vector<ModelParameter>& parameters() const = 0;
  /// p.
  std::ptrdiff_t parameter_count() const { return static_cast<std::ptrdiff_t>(parameters().size()); }

  /// x[k+1] into `next` (n). Derivatives in row-major n x p, n x n and n x m go where the pointers are not null.
  virtual void predict(const double* theta, const double* x, const double* u, double dt_s, double* next,
                       double* by_theta = nullptr, double* by_x = nullptr, double* by_u = nullptr) const = 0;

  /// One transition's data.
  struct Transition {
    const double* x;     ///< n numbers
    const double* u;     ///< m numbers
    const double* next;  ///< n numbers, the state after it
    double dt_s;         ///< its duration [s]
  };
  /// Residuals next - f(theta, x, u, dt) of `count` transitions one after the other, and the predictions' derivatives
  /// by theta (count n x p, row-major) if not null.
  virtual void residuals(const double* theta, const Transition* transitions, std::ptrdiff_t count, double* r,
                         double* by_theta) const {
    const std::ptrdiff_t n = states(), p = parameter_count();
    for (std::ptrdiff_t k = 0; k < count; ++k) {
      const Transition& t = transitions[k];
      predict(theta, t.x, t.u, t.dt_s, r + k * n, by_theta ? by_theta + k * n * p : nullptr);
      for (std::ptrdiff_t i = 0; i < n; ++i) r[k * n + i] = t.next[i] - r[k * n + i];
    }
  }
};

}  // namespace modebank
