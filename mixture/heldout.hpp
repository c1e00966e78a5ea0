#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "mixture/em.hpp"

namespace modebank {

/// Number of groups of runs that are left out in turn: one per run, at most five; run number j (in run order) belongs
/// to group j mod the number of groups. `runs` N, the run of each point.
Eigen::Index heldout_groups(const std::vector<Eigen::Index>& runs);

/// Log densities of the points of each group left out, and their weights; NaN in groups that could not be scored.
struct HeldoutScore {
  Eigen::VectorXd sums, weights;

  /// Per unit weight [nats per point]; NaN where it cannot be told, as below.
  double mean() const {
    return sums.size() > 0 ? sums.sum() / weights.sum() : std::numeric_limits<double>::quiet_NaN();
  }
};

/// Standard error of the difference of two means over the same groups, which are what is independent: of G groups with
/// differences d_g of weight w_g and their mean m, sqrt(G / (G - 1) sum (d_g - m w_g)^2) / sum w_g.
double difference_error(const HeldoutScore& a, const HeldoutScore& b);

/// Log density [nats per point] of points under mixtures fitted without their group of runs, each by up to two
/// restarts without split-and-merge moves; higher is better. Weighted points count by their weight. The mean is NaN
/// when there are fewer than two runs or a rest has fewer points than components.
HeldoutScore heldout_score(const PointSet& points, const std::vector<Eigen::Index>& runs, Eigen::Index components,
                           EmOptions options, std::uint64_t seed);

}  // namespace modebank
