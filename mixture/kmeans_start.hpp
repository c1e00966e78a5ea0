#pragma once

#include <random>

#include "mixture/gaussian_mixture.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// Cluster of every point, block_size x blocks; what filling points say does not matter.
using BlockLabels = Eigen::Array<int, block_size, Eigen::Dynamic>;

/// The moments of clusters as a start for EM. Each cluster's covariance is drawn towards the pooled within-cluster one
/// with the strength of F + 1 mean-weight points (and its weight towards 1/K with one), so an empty or one-point
/// cluster is a usable start. An empty cluster stays at its column of `centers` (F x K).
GaussianMixture mixture_of_clusters(const PointBlocks& points, const BlockLabels& labels, Eigen::MatrixXd centers,
                                    CovarianceType type, double floor);

/// A start for EM: greedy k-means++ seeding (Arthur & Vassilvitskii 2007), a few Lloyd iterations, then the clusters'
/// moments. Points should be in units of equal importance. Fewer distinct points than components gives coinciding
/// components.
GaussianMixture kmeans_start(const PointBlocks& points, Eigen::Index components, CovarianceType type, double floor,
                             std::mt19937_64& generator);

/// Components at points drawn by weight, with the moments of the points nearest to each.
GaussianMixture random_start(const PointBlocks& points, Eigen::Index components, CovarianceType type, double floor,
                             std::mt19937_64& generator);

}  // namespace modebank
