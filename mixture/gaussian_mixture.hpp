#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include "mixture/point_set.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// The component for points that belong to no cluster: uniform over a box (Fraley & Raftery 1998, Comput. J. 41,
/// section 3.3), of density 1 / volume inside it and 0 outside.
struct UniformNoise {
  double weight = 0.0;
  Eigen::VectorXd lower, upper;  ///< F, corners of the box [feature unit]; empty: the mixture has no such component

  bool present() const { return lower.size() > 0; }
  double log_density() const { return -(upper - lower).array().log().sum(); }  ///< inside the box
  bool contains(const Eigen::Ref<const Eigen::VectorXd>& point) const {
    return (point.array() >= lower.array()).all() && (point.array() <= upper.array()).all();
  }
};

/// Weighted sum of K Gaussians over F features, and of a uniform noise component where there is one. Points are F x N,
/// one point per column.
struct GaussianMixture {
  Eigen::VectorXd weights;                   ///< K, sums to 1 - noise.weight
  Eigen::MatrixXd means;                     ///< F x K
  std::vector<Eigen::MatrixXd> covariances;  ///< K of F x F
  CovarianceType type = CovarianceType::full;
  UniformNoise noise;

  Eigen::Index components() const { return weights.size(); }
  Eigen::Index features() const { return means.rows(); }
  /// Free parameters q of the information criteria: K - 1 + K F + K F (F + 1) / 2, or K - 1 + 2 K F when diagonal; 2
  /// more for a noise component, its weight and its volume (as mclust counts: nMclustParams, Scrucca et al. 2016).
  Eigen::Index parameter_count() const;
};

/// A component's covariance is not positive definite: of a fit, that its numbers are beyond double precision.
class NotPositiveDefinite : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Throws std::invalid_argument when the parts of a mixture do not fit together, or it has no component or feature.
void check_sizes(const GaussianMixture& mixture);

/// Throws std::invalid_argument when the error covariances have the wrong sizes, or one is not finite, not symmetric or
/// has a negative variance or a correlation beyond one.
void check_errors(const PointSet& points);

/// Raises the eigenvalues (`diagonal`: the variances, off-diagonals are zeroed) to `floor`; whether any was below.
bool raise_to_floor(Eigen::MatrixXd& covariance, double floor, CovarianceType type);

// The functions below throw std::invalid_argument for sizes that do not fit, for points, means or weights that are not
// finite, a negative weight and for an error covariance that is none, and NotPositiveDefinite. A
// point with an error covariance S is seen through it: component k is N(mu_k, Sigma_k + S) there (Bovy, Hogg & Roweis
// 2011, eq. 9). Weights of points are ignored.

/// log density of every point, in the log domain: N values, finite for finite points (about -1e300 where the distance
/// itself overflows).
Eigen::VectorXd log_density(const GaussianMixture& mixture, const PointSet& points);
/// Posterior component probabilities, K x N; each column sums to one, or to one minus the probability of noise.
Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const PointSet& points);
/// The same block by block, in order, without an array of K x N: visit(first, block) gets the columns of points first,
/// first + 1, ... (at most 128) and must not keep a reference to them.
void visit_responsibilities(const GaussianMixture& mixture, const PointSet& points,
                            const std::function<void(Eigen::Index, const Eigen::Ref<const Eigen::MatrixXd>&)>& visit);
/// N points drawn from the mixture; the generator is the only source of randomness.
Eigen::MatrixXd sample(const GaussianMixture& mixture, Eigen::Index count, std::mt19937_64& generator);

inline Eigen::VectorXd log_density(const GaussianMixture& mixture, const Eigen::MatrixXd& points) {
  return log_density(mixture, PointSet(points));
}
inline Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const Eigen::MatrixXd& points) {
  return responsibilities(mixture, PointSet(points));
}

}  // namespace modebank
