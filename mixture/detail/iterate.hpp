#pragma once

#include <limits>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Iteration of EM with plain steps, or with squared extrapolation (SQUAREM) if it gains.
enum class Steps { plain, extrapolated };

/// EM from `start`, in the points' units. It ends when a plain iteration gains less than the tolerance, or after
/// options.max_iterations. The log-likelihood never falls. It belongs to the returned mixture, because the last pass
/// only measures. With extrapolated steps, EM also ends early, as not converged, if it is expected to stay below
/// `hopeless_below`. The expected remaining gain, with a margin, is computed from the latest gain and the rate at which
/// steps shrink (Aitken acceleration: Boehning et al. 1994, Ann. Inst. Stat. Math. 46).
EmResult iterate(const PointBlocks& points, GaussianMixture start, const EmOptions& options, Steps steps = Steps::plain,
                 double hopeless_below = -std::numeric_limits<double>::infinity());

}  // namespace modebank
