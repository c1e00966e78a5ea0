#pragma once

#include "mixture/em.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// EM from `start` until it converges or reaches options.max_iterations, both in the points' units. The log-likelihood
/// belongs to the returned mixture: the last pass only measures it.
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options);

/// The same with extrapolated iterations, where they gain: it ends where an iteration of plain EM gains less than the
/// tolerance. The log-likelihood never falls.
EmResult converge(const PointBlocks& points, GaussianMixture start, const EmOptions& options);

}  // namespace modebank
