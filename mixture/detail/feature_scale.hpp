#pragma once

#include <Eigen/Core>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Affine map between physical units and the units mixtures are fitted in: zero mean, and as the unit of a feature the
/// typical error of its points where that is known, else their standard deviation. Without a known error, a feature
/// whose standard deviation a few outliers make more than 20 times that of the bulk (from the quantiles at 2.5 and 97.5
/// %) has zero median and the bulk's unit instead, as far as double precision allows.
struct FeatureScale {
  Eigen::VectorXd center;   ///< F, weighted mean [feature unit]
  Eigen::VectorXd scale;    ///< F [feature unit]; 1 for a constant feature of unknown error
  Eigen::VectorXd inverse;  ///< F, 1 / scale; 0 for a constant feature, whose scaled values are exactly zero

  /// A feature is constant when its spread is lost in rounding (1e-13 of its magnitude) or below 1e-150, where a
  /// covariance cannot be represented. Points of weight zero do not count. `floor` is the least variance that
  /// components will have in scaled units.
  static FeatureScale of(const PointSet& points, double floor);
  static FeatureScale identity(Eigen::Index features);
  /// Powers of two near the largest standard deviation of the components: no rounding, but numbers near one.
  static FeatureScale near_one(const GaussianMixture& mixture);

  GaussianMixture to_scaled(const GaussianMixture& mixture) const;
  GaussianMixture to_physical(const GaussianMixture& mixture) const;
  /// log |d scaled / d physical| of one point: add (times the weight) to a scaled log density for the physical one.
  double log_jacobian() const { return -scale.array().log().sum(); }
};

/// The noise component's box in physical units: that of the points of positive weight, and in each feature at least as
/// wide as the uniform distribution of variance `floor` (in scaled units), so that its volume is never zero.
UniformNoise bounding_box(const PointSet& points, const FeatureScale& scale, double floor);

}  // namespace modebank
