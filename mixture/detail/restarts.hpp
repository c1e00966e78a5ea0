#pragma once

#include <cstdint>
#include <functional>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Combines two mixtures of the same K, features and type. The result keeps the components on which both mixtures
/// agree. Among the other components, it keeps the most different ones. Method: takes all 2 K components at half their
/// weight and merges the two closest (reduction.hpp) until K remain. If both mixtures are equal, the result is the same
/// mixture. The time is K^2 per merge.
GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b);

/// The best optimum of options.restarts restarts, in the points' units, and the number of restarts that reached it.
///
/// 1. Each restart climbs from its start to near an optimum and tries split-and-merge moves, independently of all other
/// restarts.
/// 2. Unless moves are off, the best restart is crossed with each other restart (`cross`). The result of a crossing
/// also climbs. It replaces the other restart if it ends higher. This is one generation of genetic EM (Pernkopf &
/// Bouchaffra 2005, IEEE Trans. Pattern Anal. Mach. Intell. 27, 1344-1348).
/// 3. The best restart is followed to the tolerance. Other restarts are followed only while they may still reach the
/// best one (see `iterate`). Restarts that a crossing replaced are followed, too. Agreement counts the optima that each
/// restart found by itself, because a crossing resembles the best restart.
EmResult best_of_restarts(const PointBlocks& points, const std::function<GaussianMixture(int)>& start_of,
                          const EmOptions& options, std::uint64_t seed);

}  // namespace modebank
