#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mixture/detail/cloud.hpp"
#include "mixture/em.hpp"

namespace modebank {

/// A move: it merges two components and splits a third one.
struct SplitMergeMove {
  Eigen::Index merged = 0, absorbed = 0, split = 0;
  GaussianMixture parts;  ///< the two parts of the split component; their weights sum to one
  double gain = 0.0;      ///< expected change of the mean log-likelihood [nats per unit weight]
};

/// The most promising moves, at most `most`, the best first. With fewer than three components there are no moves. The
/// gain of a split is the gain of EM with two components on the points of one component, weighted by responsibility
/// (partial EM: Ueda, Nakano, Ghahramani & Hinton 2000, Neural Comput. 12, section 3). Two starts are tried: two
/// halves, and a dense core with a wide shell. The cost of a merge is that of merges_by_loss. `points` (F x n) is a
/// sample. The covariance type and floor are those of the options.
std::vector<SplitMergeMove> split_merge_moves(const GaussianMixture& mixture, const Eigen::MatrixXd& points,
                                              const EmOptions& options, std::size_t most);

/// The mixture after a move; the merged pair keeps its moments.
GaussianMixture apply(const SplitMergeMove& move, const GaussianMixture& mixture);

/// Improves `fit` by split-and-merge moves. Each round ranks the options.split_merge most promising moves by a short EM
/// run on a sample of the points (drawn by `seed`). EM after the best move runs to its end. Its result is kept if its
/// likelihood is higher. A run that cannot exceed the present likelihood ends early (`iterate`). Rounds end when no
/// move gains. The result is never worse than `fit`.
EmResult split_and_merge(const PointBlocks& points, EmResult fit, const EmOptions& options, std::uint64_t seed);

}  // namespace modebank
