#pragma once

#include <limits>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Iteration of EM: plain steps, or squared extrapolation (SQUAREM) where it gains.
enum class Steps { plain, extrapolated };

/// EM from `start`, in the points' units, until a plain iteration gains less than the tolerance or
/// options.max_iterations are used up. The log-likelihood never falls. It belongs to the returned mixture, because the
/// last pass only measures.
/// With extrapolated steps it also ends, not converged, if the expected remaining gain leaves it below
/// `hopeless_below`. That gain follows from the latest gain and the rate at which steps shrink (Aitken acceleration:
/// Boehning et al. 1994, Ann. Inst. Stat. Math. 46), with a margin.
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options, Steps steps = Steps::plain,
                 double hopeless_below = -std::numeric_limits<double>::infinity());

}  // namespace modebank
