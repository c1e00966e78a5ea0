#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace modebank {

/// One parameter of a motion model: what it is called, its unit, where a search for it starts and where it may lie.
struct ModelParameter {
  std::string name;
  std::string unit;
  double start = 0.0;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
};

/// A model of motion with p parameters: a one-step prediction x[k+1] = f(theta, x[k], u[k], dt) of n states from m
/// inputs held over the step. Written once as a template (templated_model.hpp), which supplies the derivatives.
/// Immutable, shared by threads.
class MotionModel {
 public:
  virtual ~MotionModel() = default;
  virtual const std::string& name() const = 0;
  virtual Eigen::Index states() const = 0;
  virtual Eigen::Index inputs() const = 0;
  virtual const std::vector<ModelParameter>& parameters() const = 0;
  Eigen::Index parameter_count() const { return static_cast<Eigen::Index>(parameters().size()); }

  /// x[k+1] into `next` (n). Derivatives in row-major n x p, n x n and n x m go where the pointers are not null.
  virtual void predict(const double* theta, const double* x, const double* u, double dt_s, double* next,
                       double* by_theta = nullptr, double* by_x = nullptr, double* by_u = nullptr) const = 0;

  /// One transition's data; the pointers lead to n, m and n numbers.
  struct Transition {
    const double* x;
    const double* u;
    const double* next;
    double dt_s;
  };
  /// Residuals next - f(theta, x, u, dt) of `count` transitions one after the other, and the predictions' derivatives
  /// by theta (count n x p, row-major) if not null.
  virtual void residuals(const double* theta, const Transition* transitions, Eigen::Index count, double* r,
                         double* by_theta) const {
    const Eigen::Index n = states(), p = parameter_count();
    for (Eigen::Index k = 0; k < count; ++k) {
      const Transition& t = transitions[k];
      predict(theta, t.x, t.u, t.dt_s, r + k * n, by_theta ? by_theta + k * n * p : nullptr);
      for (Eigen::Index i = 0; i < n; ++i) r[k * n + i] = t.next[i] - r[k * n + i];
    }
  }
};

/// Facts that a model may need beyond what it estimates.
struct ModelSettings {
  Eigen::Index states = 1;
  Eigen::Index inputs = 2;
  double wheel_radius_m = 1.0;  ///< turns wheel speeds in rad/s into m/s; 1 for inputs that are m/s already
};

/// The models in ident/models, one header each, by the header's name.
std::vector<std::string> motion_model_names();

/// Throws ConfigurationError for an unknown name (says which exist) and for states or inputs that the model does not
/// have (says which it has).
std::shared_ptr<const MotionModel> make_motion_model(const std::string& name, const ModelSettings& settings);

}  // namespace modebank
