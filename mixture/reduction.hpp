#pragma once

#include <vector>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// One component of a mixture.
struct Component {
  double weight;
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

Component component_of(const GaussianMixture& mixture, Eigen::Index k);
void put(const Component& component, Eigen::Index k, GaussianMixture& mixture);

/// Merges components i and j into one component of the same weight, mean and covariance (its diagonal for diagonal
/// mixtures).
Component merged(const GaussianMixture& mixture, Eigen::Index i, Eigen::Index j);

/// A pair i < j and the cost of merging it.
struct Merge {
  Eigen::Index first, second;
  double loss;  ///< upper bound of the loss in mean log-likelihood per unit weight [nats]
};

/// Cost of merging components i and j, given log |P_i| and log |P_j|. It is the bound of Runnalls 2007,
/// "Kullback-Leibler approach to Gaussian mixture reduction", IEEE Trans. Aerospace and Electronic Systems 43(3), eq.
/// 16: ((w_i + w_j) log |P_ij| - w_i log |P_i| - w_j log |P_j|) / 2.
double merge_loss(const GaussianMixture& mixture, Eigen::Index i, Eigen::Index j, double log_determinant_i,
                  double log_determinant_j);

/// All pairs in increasing order of merge_loss.
std::vector<Merge> merges_by_loss(const GaussianMixture& mixture);

/// Greedy reduction of a mixture: repeatedly merges the pair with the least merge_loss (Runnalls 2007, section V). A
/// merged component takes the place of the earlier of the two. On a tie, the first pair is merged. The start and each
/// merge take time K^2.
class Reduction {
 public:
  explicit Reduction(GaussianMixture mixture);

  Eigen::Index components() const { return std::ssize(alive_); }

  /// Positions of the merged component and of the absorbed component, among the components before the merge.
  struct Pair {
    Eigen::Index into, absorbed;
  };
  /// Merges the closest pair. Requires at least two components.
  Pair merge_closest();

  /// The remaining components, in order.
  GaussianMixture mixture() const;

 private:
  Pair closest() const;
  double loss(Eigen::Index i, Eigen::Index j) const;

  GaussianMixture mixture_;
  Eigen::MatrixXd loss_;  // costs of all pairs i < j
  std::vector<double> log_determinants_;
  std::vector<Eigen::Index> alive_;  // positions of the remaining components, in order
};

}  // namespace modebank
