#pragma once

#include <vector>

#include "mixture/gaussian_mixture.hpp"

namespace modebank {

/// log |covariance| of a positive definite matrix.
double log_determinant(const Eigen::MatrixXd& covariance);

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

}  // namespace modebank
