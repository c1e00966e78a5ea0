#pragma once

#include <vector>

#include "mixture/component_merge.hpp"

namespace modebank {

/// Greedy reduction of a mixture: the pair of least merge_loss becomes one component (merged), again and again
/// (Runnalls 2007, section V; see component_merge.hpp). A merged component stays in the earlier one's place, and of
/// pairs that cost the same the first goes first. Time K^2 at first and per merge.
class Reduction {
 public:
  explicit Reduction(GaussianMixture mixture);

  Eigen::Index components() const { return std::ssize(alive_); }

  /// Places, among the components as they were before, of the merged one and of the one that it absorbed.
  struct Pair {
    Eigen::Index into, absorbed;
  };
  /// Needs two components.
  Pair merge_closest();

  /// What is left, in order.
  GaussianMixture mixture() const;

 private:
  Pair closest() const;
  double loss(Eigen::Index i, Eigen::Index j) const;

  GaussianMixture mixture_;
  Eigen::MatrixXd loss_;  // of i < j
  std::vector<double> log_determinants_;
  std::vector<Eigen::Index> alive_;  // in order
};

}  // namespace modebank
