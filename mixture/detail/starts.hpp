#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Where a restart begins, and the EM iterations spent on finding it.
struct Start {
  GaussianMixture mixture;
  int iterations = 0;
};

/// Start number `restart` of EM over a cloud: the best of options.start_runs short runs (emEM: Biernacki, Celeux &
/// Govaert 2003, Comput. Stat. Data Anal. 41, section 2.2), on a subsample of many points. Depends on components,
/// restart and seed alone.
Start make_start(const ScaledCloud& cloud, Eigen::Index components, int restart, const EmOptions& options,
                 std::uint64_t seed);

/// Greedy k-means++ seeding (Arthur & Vassilvitskii 2007), a few Lloyd iterations, then the clusters' moments. Points
/// should be in units of equal importance. Fewer distinct points than components gives coinciding components.
GaussianMixture kmeans_start(const PointBlocks& points, Eigen::Index components, const EmOptions& options,
                             std::mt19937_64& generator);

/// Components at points drawn by weight, with the moments of the points nearest to each.
GaussianMixture random_start(const PointBlocks& points, Eigen::Index components, const EmOptions& options,
                             std::mt19937_64& generator);

/// At most `most` of the points with weight, evenly spread over their order, F x n.
Eigen::MatrixXd sample_points(const PointBlocks& points, Eigen::Index most, std::mt19937_64& generator);

}  // namespace modebank
