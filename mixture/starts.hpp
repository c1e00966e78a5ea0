#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <random>
#include <vector>

#include "mixture/em.hpp"
#include "mixture/hierarchical.hpp"
#include "mixture/scaled_cloud.hpp"

namespace modebank {

/// Where a restart begins, and the EM iterations spent on finding it.
struct Start {
  GaussianMixture mixture;
  int iterations = 0;
};

/// The starts of EM over one cloud (in units of equal importance). What does not depend on the number of components is
/// computed once, so that candidates share it. A start depends on components, restart and seed alone.
class Starts {
 public:
  /// `cloud` must outlive this.
  Starts(const ScaledCloud& cloud, const EmOptions& options);

  /// Where restart number `restart` begins.
  Start make(Eigen::Index components, int restart, std::uint64_t seed) const;

 private:
  struct Tree {
    Eigen::MatrixXd subsample;  // F x n
    Agglomeration merges;
  };

  GaussianMixture hierarchical(const Tree& tree, Eigen::Index components) const;
  /// Of more components than wanted the densest, and the noise component that was asked for.
  GaussianMixture with_noise(GaussianMixture start, Eigen::Index components) const;
  Start fresh_start(Eigen::Index components, bool random, int runs, std::mt19937_64& generator) const;

  const ScaledCloud& cloud_;
  EmOptions options_;
  std::vector<Tree> trees_;  // of the first restarts
};

/// At most `most` of the points with weight, evenly spread over their order, F x n.
Eigen::MatrixXd sample_points(const PointBlocks& points, Eigen::Index most, std::mt19937_64& generator);

}  // namespace modebank
