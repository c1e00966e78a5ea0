#pragma once

#include <Eigen/Core>

/// The interface between free runs and the models that predict (filter/step/forecast.hpp).
namespace modebank {

/// A model's prediction of the measurement some steps ahead: the distribution of each signal, and the joint density.
class Forecast {
 public:
  virtual ~Forecast() = default;
  /// Advances by one model step under these acting inputs.
  virtual void step(const Eigen::Ref<const Eigen::VectorXd>& inputs) = 0;
  /// Call this for each sample, before the queries below. `samples`: number of samples ahead, at least 1.
  virtual void arrive(Eigen::Index /*samples*/) {}

  virtual Eigen::VectorXd mean() const = 0;                ///< n_y
  virtual Eigen::VectorXd standard_deviation() const = 0;  ///< n_y

  /// P(y_i <= y), and its inverse: the y with that probability.
  virtual double probability(Eigen::Index i, double y) const = 0;
  virtual double quantile(Eigen::Index i, double probability) const = 0;
  /// Joint log density of all signals [nats].
  virtual double log_density(const Eigen::Ref<const Eigen::VectorXd>& y) = 0;
  virtual Eigen::VectorXd mode_probability() const = 0;  ///< K

 protected:
  Forecast() = default;
  Forecast(const Forecast&) = default;
  Forecast& operator=(const Forecast&) = default;
};

}  // namespace modebank
