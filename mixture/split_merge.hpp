#pragma once

#include <Eigen/Core>
#include <vector>

#include "mixture/em.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// Takes two components together and divides a third.
struct SplitMergeMove {
  Eigen::Index merged = 0, absorbed = 0, split = 0;
};

/// The moves that look best, best first, at most `most` (Ueda, Nakano, Ghahramani & Hinton 2000, Neural Comput. 12,
/// section 3.2): pairs whose responsibilities are most alike over `points` (F x n) are merged, components whose density
/// fits their own points worst (local Kullback divergence) are split. None for fewer than three components.
std::vector<SplitMergeMove> split_merge_moves(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                              Eigen::Index most);

/// The mixture after a move: the merged pair by its moments, the split one as two halves along its longest axis.
GaussianMixture apply(const SplitMergeMove& move, const GaussianMixture& mixture);

/// Leaves a poor optimum: of the best options.split_merge moves the one that has gained most after a short EM run is
/// followed to its end, and kept when the likelihood is higher; again until a round brings nothing. Never worse than
/// `fit`.
EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options);

}  // namespace modebank
