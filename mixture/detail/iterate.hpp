#pragma once

#include <limits>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// How EM gets from one iteration to the next: by its own steps, or by squared extrapolation (SQUAREM) where that
/// gains.
enum class Steps { plain, extrapolated };

/// EM from `start`, in the points' units, until an iteration of plain EM gains less than the tolerance or
/// options.max_iterations are made. The log-likelihood never falls, and belongs to the returned mixture: the last pass
/// only measures it. With extrapolated steps it also ends, without having converged, where what is still to be gained
/// would leave it below `hopeless_below`: taken from the latest gain and the rate at which EM's steps shrink (Boehning
/// et al. 1994, Ann. Inst. Stat. Math. 46: Aitken acceleration), with a margin.
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options, Steps steps = Steps::plain,
                 double hopeless_below = -std::numeric_limits<double>::infinity());

}  // namespace modebank
