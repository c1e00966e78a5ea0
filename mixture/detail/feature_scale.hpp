#pragma once

#include <Eigen/Core>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// Affine map from physical units to the units of the fit. Each feature has zero mean. Its unit is the typical error of
/// its points; if the error is unknown, it is the standard deviation of the points. The bulk's standard deviation
/// follows from the quantiles at 2.5 and 97.5 %. If outliers make the standard deviation more than 20 times as large as
/// that, the feature has zero median and the bulk's standard deviation as unit, within the limits of double precision.
struct FeatureScale {
  Eigen::VectorXd center;   ///< F, weighted mean [feature unit]
  Eigen::VectorXd scale;    ///< F [feature unit]; 1 for a constant feature whose error is unknown
  Eigen::VectorXd inverse;  ///< F, 1 / scale; 0 for a constant feature, whose scaled values are exactly zero

  /// The map for these points. A feature is constant if its standard deviation is below 1e-13 of its magnitude (lost in
  /// rounding) or below 1e-150 (a covariance would underflow). Ignores points of weight zero. `floor` is the smallest
  /// variance of a component in scaled units.
  static FeatureScale of(const PointSet& points, double floor);
  static FeatureScale identity(Eigen::Index features);
  /// Units that are powers of two near the components' largest standard deviation. Scaling with them causes no
  /// rounding, and scaled numbers are near one.
  static FeatureScale near_one(const GaussianMixture& mixture);

  GaussianMixture to_scaled(const GaussianMixture& mixture) const;
  GaussianMixture to_physical(const GaussianMixture& mixture) const;
  /// log |d scaled / d physical| of one point. A scaled log density plus this value (times the weight) is the physical
  /// log density.
  double log_jacobian() const { return -scale.array().log().sum(); }
};

/// The noise component's box in physical units: the bounding box of the points of positive weight. Each side has at
/// least the length of a uniform distribution with variance `floor` (scaled units), so the volume is positive.
UniformNoise bounding_box(const PointSet& points, const FeatureScale& scale, double floor);

}  // namespace modebank
