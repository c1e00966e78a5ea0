#pragma once

#include <limits>

#include "mixture/em.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// EM from `start` until it converges or reaches options.max_iterations, both in the points' units. The log-likelihood
/// belongs to the returned mixture: the last pass only measures it.
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options);

/// The same with extrapolated iterations, where they gain: it ends where an iteration of plain EM gains less than the
/// tolerance. The log-likelihood never falls. It also ends, without having converged, where what is still to be gained
/// would leave it below `hopeless_below`: taken from the latest gain and the rate at which EM's steps shrink (Boehning
/// et al. 1994, Ann. Inst. Stat. Math. 46: Aitken acceleration), with a margin.
EmResult converge(const PointBlocks& points, GaussianMixture start, const EmOptions& options,
                  double hopeless_below = -std::numeric_limits<double>::infinity());

}  // namespace modebank
