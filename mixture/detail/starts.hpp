#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Start number `restart` of EM over a cloud: a random_start on at most 50,000 points. The result depends on
/// components, restart and seed alone.
GaussianMixture make_start(const ScaledCloud& cloud, Eigen::Index components, int restart, const EmOptions& options,
                           std::uint64_t seed);

/// A start whose components lie at points drawn by weight. Each component has the moments of the points nearest to it.
/// Points should be in units of equal importance. If there are fewer distinct points than components, some components
/// coincide.
GaussianMixture random_start(const PointBlocks& points, Eigen::Index components, const EmOptions& options,
                             std::mt19937_64& generator);

/// At most `most` points of positive weight, evenly spread over their order, F x n.
Eigen::MatrixXd sample_points(const PointBlocks& points, Eigen::Index most, std::mt19937_64& generator);

}  // namespace modebank
