#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/em.hpp"

namespace modebank {

/// Number of groups of runs that are left out in turn: one per run, at most five; run number j (in run order) belongs
/// to group j mod the number of groups. `runs` N, the run of each point.
Eigen::Index heldout_groups(const std::vector<Eigen::Index>& runs);

/// Mean log density [nats per point] of points under mixtures fitted without their group of runs, each by up to two
/// restarts without split-and-merge moves; higher is better. Weighted points count by their weight. NaN when there are
/// fewer than two runs or a rest has fewer points than components.
double heldout_score(const PointSet& points, const std::vector<Eigen::Index>& runs, Eigen::Index components,
                     EmOptions options, std::uint64_t seed);

}  // namespace modebank
