#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Start number `restart` of EM over a cloud, a random_start on 50,000 points at most. Depends on components, restart
/// and seed alone.
GaussianMixture make_start(const ScaledCloud& cloud, Eigen::Index components, int restart, const EmOptions& options,
                           std::uint64_t seed);

/// Components at points drawn by weight, with the moments of the points nearest to each. Points should be in units of
/// equal importance. Fewer distinct points than components gives coinciding components.
GaussianMixture random_start(const PointBlocks& points, Eigen::Index components, const EmOptions& options,
                             std::mt19937_64& generator);

/// At most `most` of the points with weight, evenly spread over their order, F x n.
Eigen::MatrixXd sample_points(const PointBlocks& points, Eigen::Index most, std::mt19937_64& generator);

}  // namespace modebank
