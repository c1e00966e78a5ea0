#pragma once

#include <vector>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// One component of a mixture on its own.
struct Component {
  double weight;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Component component_of(const GaussianMixture& mixture, Eigen::Index k);
void put(const Component& component, Eigen::Index k, GaussianMixture& mixture);

/// Components i and j as one of the same weight, mean and covariance (its diagonal for diagonal mixtures).
Component merged(const GaussianMixture& mixture, Eigen::Index i, Eigen::Index j);

/// A pair i < j and what merging it costs.
struct Merge {
  Eigen::Index first, second;
  double loss;  ///< expected mean log-likelihood per unit weight, at most [nats]
};

/// What merging i and j costs, given log |P_i| and log |P_j|: the bound of Runnalls 2007, "Kullback-Leibler approach to
/// Gaussian mixture reduction", IEEE Trans. Aerospace and Electronic Systems 43(3), eq. 16:
///   ((w_i + w_j) log |P_ij| - w_i log |P_i| - w_j log |P_j|) / 2.
double merge_loss(const GaussianMixture& mixture, Eigen::Index i, Eigen::Index j, double log_determinant_i,
                  double log_determinant_j);

/// All pairs, the least merge_loss first.
std::vector<Merge> merges_by_loss(const GaussianMixture& mixture);

/// Greedy reduction of a mixture: the pair of least merge_loss becomes one component (merged), again and again
/// (Runnalls 2007, section V). A merged component stays in the earlier one's place, and of
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
