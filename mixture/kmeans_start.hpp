#pragma once

#include <random>

#include "mixture/gaussian_mixture.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// A start for EM: k-means++ seeding (Arthur & Vassilvitskii 2007), at most ten Lloyd iterations, then the moments of
/// the clusters. Each cluster's covariance is drawn towards the pooled within-cluster one with the strength of F + 1
/// mean-weight points (and its weight towards 1/K with one), so an empty or one-point cluster is a usable start.
/// Points should be in units of equal importance. Fewer distinct points than components gives coinciding components.
GaussianMixture kmeans_start(const PointBlocks& points, Eigen::Index components, CovarianceType type, double floor,
                             std::mt19937_64& generator);

}  // namespace modebank
