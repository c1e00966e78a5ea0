#pragma once

#include "mixture/em.hpp"
#include "mixture/feature_scale.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// The cloud in the units it is fitted in.
struct ScaledCloud {
  FeatureScale scale;
  PointBlocks points;
  UniformNoise noise;  ///< physical units; absent unless asked for

  ScaledCloud(const PointSet& set, const EmOptions& options)
      : scale(FeatureScale::of(set, options.covariance_floor)), points(set, scale) {
    if (!options.noise_component) return;
    noise = bounding_box(set, scale, options.covariance_floor);
    constexpr double noise_start = 0.05;
    noise.weight = noise_start;
  }

  /// Gives a mixture in scaled units the noise component that was asked for, and no other.
  void set_noise(GaussianMixture& scaled) const {
    const double kept = scaled.noise.weight > 0.0 ? scaled.noise.weight : noise.weight;
    GaussianMixture box = scaled;
    box.noise = noise;
    scaled.noise = scale.to_scaled(box).noise;
    if (noise.present()) scaled.noise.weight = kept;
    scaled.weights *= (1.0 - (noise.present() ? kept : 0.0)) / scaled.weights.sum();
  }
};

}  // namespace modebank
