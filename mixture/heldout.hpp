#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "mixture/em.hpp"

namespace modebank {

/// Number of groups of runs that are left out in turn. Each run is a group if there are at most five runs; otherwise
/// there are five groups. Run number j (in run order) belongs to group j mod the number of groups. `runs` (N): run of
/// each point.
Eigen::Index heldout_groups(const std::vector<Eigen::Index>& runs);

/// Log densities of the points of each left-out group, and their weights. NaN for groups that could not be scored.
struct HeldoutScore {
  Eigen::VectorXd sums, weights;

  /// Mean log density per unit weight [nats per point]; NaN if it is not defined (see heldout_score).
  double mean() const {
    return sums.size() > 0 ? sums.sum() / weights.sum() : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Standard error of the difference of two means over the same groups, which are independent. For G groups with
/// differences d_g of weight w_g and mean m it is sqrt(G / (G - 1) sum (d_g - m w_g)^2) / sum w_g.
double difference_error(const HeldoutScore& a, const HeldoutScore& b);

/// Log density [nats per point] of points under mixtures that were fitted without the points' group of runs; higher is
/// better. Each fit has up to two restarts without split-and-merge moves. Points are weighted. The mean is NaN with
/// fewer than two runs, or if fewer points remain than there are components.
HeldoutScore heldout_score(const PointSet& points, const std::vector<Eigen::Index>& runs, Eigen::Index components,
                           EmOptions options, std::uint64_t seed);

}  // namespace modebank
