#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace modebank {

/// One parameter of a motion model: name, unit, start and bounds of a search.
struct ModelParameter {
  std::string name;                                         ///< name in results
  std::string unit;                                         ///< unit of the parameter; may be empty
  double start = 0.0;                                       ///< start value of a search
  double lower = -std::numeric_limits<double>::infinity();  ///< lower bound
  double upper = std::numeric_limits<double>::infinity();   ///< upper bound
};

/// A motion model with p parameters: a one-step prediction x[k+1] = f(theta, x[k], u[k], dt) of n states, with m inputs
/// held over the step. Immutable and shared by threads. Users may add motion models: an AutoDiffMotionModel
/// (auto_diff_motion_model.hpp) from one equation, or a derived class with hand-written derivatives.
class MotionModel {
 public:
  virtual ~MotionModel() = default;
  /// Model name in results. It must differ from modebank's own names.
  virtual const std::string& name() const = 0;
  /// Number of states n.
  virtual std::ptrdiff_t states() const = 0;
  /// Number of inputs m.
  virtual std::ptrdiff_t inputs() const = 0;
  /// The p parameters.
  virtual const std::vector<ModelParameter>& parameters() const = 0;
  /// Number of parameters p.
  std::ptrdiff_t parameter_count() const { return static_cast<std::ptrdiff_t>(parameters().size()); }

  /// Predicts x[k+1] into `next` (n). Writes row-major derivatives (n x p, n x n, n x m) to the pointers that are not
  /// null.
  virtual void predict(const double* theta, const double* x, const double* u, double dt_s, double* next,
                       double* by_theta = nullptr, double* by_x = nullptr, double* by_u = nullptr) const = 0;

  /// Data of one transition.
  struct Transition {
    const double* x;     ///< n numbers
    const double* u;     ///< m numbers
    const double* next;  ///< n numbers: the next state
    double dt_s;         ///< duration of the transition [s]
  };
  /// Residuals next - f(theta, x, u, dt) of `count` consecutive transitions. If the pointer is not null, also writes
  /// the derivatives of the predictions with respect to theta (count n x p, row-major).
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
