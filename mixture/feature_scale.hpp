#pragma once

#include <Eigen/Core>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Affine map between physical units and the units mixtures are fitted in: zero mean, unit standard deviation.
struct FeatureScale {
  Eigen::VectorXd center;  ///< F, weighted mean [feature unit]
  Eigen::VectorXd scale;   ///< F, weighted population standard deviation [feature unit]; 1 for a constant feature

  /// A feature is constant when its spread is lost in rounding (1e-13 of its magnitude) or below 1e-150, where a
  /// covariance cannot be represented; its scaled values are exactly zero. `weights` N.
  static FeatureScale of(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights);

  Eigen::MatrixXd to_scaled(const Eigen::MatrixXd& points) const;
  GaussianMixture to_scaled(const GaussianMixture& mixture) const;
  GaussianMixture to_physical(const GaussianMixture& mixture) const;
  /// log |d scaled / d physical| of one point: add (times the weight) to a scaled log density for the physical one.
  double log_jacobian() const { return -scale.array().log().sum(); }

 private:
  Eigen::Array<bool, Eigen::Dynamic, 1> constant_;  ///< F
};

}  // namespace modebank
