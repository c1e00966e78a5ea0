#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// Takes two components together and divides a third.
struct SplitMergeMove {
  Eigen::Index merged = 0, absorbed = 0, split = 0;
  GaussianMixture parts;  ///< the two that the third becomes, weights summing to one
  double gain = 0.0;      ///< expected change of the mean log-likelihood [nats per unit weight]
};

/// The moves that promise most, best first, at most `most`; none for fewer than three components. Splitting gains what
/// EM with two components gains on the points of one (weighted by responsibility: the partial EM of Ueda, Nakano,
/// Ghahramani & Hinton 2000, Neural Comput. 12, section 3), from its halves or from a dense core and a wide shell.
/// Merging costs what merges_by_loss says.
/// `points` F x n, a sample; the options' covariance type and floor hold.
std::vector<SplitMergeMove> split_merge_moves(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                              const EmOptions& options, std::size_t most);

/// The mixture after a move, the merged pair by its moments.
GaussianMixture apply(const SplitMergeMove& move, const GaussianMixture& mixture);

/// Leaves a poor optimum: of the most promising options.split_merge moves the one that has gained most after a short EM
/// run is followed to its end, and kept when the likelihood is higher; again until a round brings nothing. Moves are
/// ranked on a sample of the points (`seed`). A run that will not get above the present likelihood ends early
/// (`iterate`). Never worse than `fit`.
EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options, std::uint64_t seed);

}  // namespace modebank
