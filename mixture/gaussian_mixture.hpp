#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "ident/enum_names.hpp"

namespace modebank {

enum class CovarianceType { full, diagonal };

template <>
struct EnumNames<CovarianceType> {
  static constexpr Names<2> values{"full", "diagonal"};
};

/// Weighted sum of K Gaussians over F features. Points are F x N, one point per column.
struct GaussianMixture {
  Eigen::VectorXd weights;                   ///< K, sums to one
  Eigen::MatrixXd means;                     ///< F x K
  std::vector<Eigen::MatrixXd> covariances;  ///< K of F x F
  CovarianceType type = CovarianceType::full;

  Eigen::Index components() const { return weights.size(); }
  Eigen::Index features() const { return means.rows(); }
  /// Free parameters q of the information criteria: K - 1 + K F + K F (F + 1) / 2, or K - 1 + 2 K F when diagonal.
  Eigen::Index parameter_count() const;
};

/// Throws std::invalid_argument when the parts of a mixture do not fit together, or it has no component or feature.
void check_sizes(const GaussianMixture& mixture);

// The functions below throw std::invalid_argument for sizes that do not fit and for a covariance that is not positive
// definite.

/// log sum_k w_k N(x; mu_k, Sigma_k) of every point, in the log domain: N values, finite for finite points (about
/// -1e300 where the distance itself overflows).
Eigen::VectorXd log_density(const GaussianMixture& mixture, const Eigen::MatrixXd& points);
/// Posterior component probabilities, K x N; each column sums to one.
Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const Eigen::MatrixXd& points);
/// N points drawn from the mixture; the generator is the only source of randomness.
Eigen::MatrixXd sample(const GaussianMixture& mixture, Eigen::Index count, std::mt19937_64& generator);

}  // namespace modebank
