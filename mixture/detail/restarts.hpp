#pragma once

#include <cstdint>
#include <functional>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// A mixture that has what two mixtures of the same K, features and type agree on, and of the rest what differs most:
/// the components of both at half their weight, the two closest merged (reduction.hpp) until K are left. Mixtures that
/// are the same give themselves. Time K^2 per merge.
GaussianMixture cross(const GaussianMixture& a, const GaussianMixture& b);

/// The best optimum of options.restarts restarts, in the points' units, with the number of restarts that agree with it.
///
/// 1. Every restart climbs from its start to near an optimum and tries split-and-merge moves out of it, on its own.
/// 2. Unless moves are turned off, the best is crossed with each of the others (`cross`); that start climbs as well
///    and takes the other's place where it ends higher: a generation of genetic EM (Pernkopf & Bouchaffra 2005, IEEE
///    Trans. Pattern Anal. Mach. Intell. 27, 1344-1348).
/// 3. The best is followed to the tolerance. Of the others only those that may still reach it are, as far as it takes
///    to tell (see `iterate`); so are restarts whose place a crossing took: agreement is counted among what each
///    restart found by itself, because whatever is crossed with the best resembles it.
/// Restarts run in parallel; what they are compared with is settled between the steps, so that the result does not
/// depend on threads.
EmResult best_of_restarts(const PointBlocks& points, const std::function<GaussianMixture(int)>& start_of,
                          const EmOptions& options, std::uint64_t seed);

}  // namespace modebank
