#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "mixture/em.hpp"
#include "mixture/features.hpp"

namespace modebank {

/// Number of groups of runs that are left out in turn: one per run, at most five; run number j (in run order) belongs
/// to group j mod the number of groups.
Eigen::Index heldout_groups(const FeatureCloud& cloud);

/// Mean log density [nats per window] of windows under mixtures fitted without their group of runs; higher is better.
/// NaN when there are fewer than two runs or a rest has fewer points than components.
double heldout_score(const FeatureCloud& cloud, Eigen::Index components, const EmOptions& options, std::uint64_t seed);

}  // namespace modebank
