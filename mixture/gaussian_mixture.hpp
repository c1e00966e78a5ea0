#pragma once

#include <Eigen/Core>
#include <functional>
#include <random>
#include <stdexcept>
#include <vector>

#include "mixture/point_set.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {

/// Component for points that belong to no cluster: uniform over a box (Fraley & Raftery 1998, Comput. J. 41, section
/// 3.3). Its density is 1 / volume inside the box and 0 outside.
struct UniformNoise {
  double weight = 0.0;
  Eigen::VectorXd lower, upper;  ///< F, corners of the box [feature unit]; empty if the mixture has no noise component

  bool present() const { return lower.size() > 0; }
  double log_density() const { return -(upper - lower).array().log().sum(); }  ///< density inside the box
  bool contains(const Eigen::Ref<const Eigen::VectorXd>& point) const {
    return (point.array() >= lower.array()).all() && (point.array() <= upper.array()).all();
  }
};

/// Weighted sum of K Gaussians over F features, with an optional uniform noise component. Points are F x N, one point
/// per column.
struct GaussianMixture {
  Eigen::VectorXd weights;                   ///< K, weights; the sum is 1 - noise.weight
  Eigen::MatrixXd means;                     ///< F x K
  std::vector<Eigen::MatrixXd> covariances;  ///< K covariances of size F x F
  CovarianceType type = CovarianceType::full;
  UniformNoise noise;

  Eigen::Index components() const { return weights.size(); }
  Eigen::Index features() const { return means.rows(); }
  /// Free parameters q of the information criteria: K - 1 + K F + K F (F + 1) / 2, or K - 1 + 2 K F if diagonal. A
  /// noise component adds 2: its weight and its volume (the same count as in mclust: nMclustParams, Scrucca et al.
  /// 2016).
  Eigen::Index parameter_count() const;
};

/// Error: a component's covariance is not positive definite. In a fit, the cause is numbers beyond double precision.
class NotPositiveDefinite : public std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// Throws std::invalid_argument if the sizes of a mixture's parts do not fit together, or if it has no component or no
/// feature.
void check_sizes(const GaussianMixture& mixture);

/// Throws std::invalid_argument for invalid error covariances: wrong sizes, entries that are not finite, not symmetric,
/// a negative variance or a correlation beyond one.
void check_errors(const PointSet& points);

/// Raises the eigenvalues of a covariance to `floor`. If `diagonal`, raises the variances instead, and sets the
/// off-diagonals to zero. Returns whether any value was below `floor`.
bool raise_to_floor(Eigen::MatrixXd& covariance, double floor, CovarianceType type);

// The functions below throw std::invalid_argument for sizes that do not fit, values that are not finite, a negative
// weight and an invalid error covariance. They also throw NotPositiveDefinite. For a point with error covariance S,
// component k has density N(mu_k, Sigma_k + S) (Bovy, Hogg & Roweis 2011, eq. 9). Weights of points are ignored.

/// Log density of every point, computed in the log domain: N values, finite for finite points. If the distance
/// overflows, the value is about -1e300.
Eigen::VectorXd log_density(const GaussianMixture& mixture, const PointSet& points);
/// Posterior component probabilities, K x N; each column sums to one, or to one minus the probability of noise.
Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const PointSet& points);
/// `responsibilities` block by block, in order, without a K x N array. visit(first, block) gets the columns of points
/// first, first + 1, ... (at most 128). It must not keep a reference to the block.
void visit_responsibilities(const GaussianMixture& mixture, const PointSet& points,
                            const std::function<void(Eigen::Index, const Eigen::Ref<const Eigen::MatrixXd>&)>& visit);
/// N points drawn from the mixture. The generator is the only source of randomness.
Eigen::MatrixXd sample(const GaussianMixture& mixture, Eigen::Index count, std::mt19937_64& generator);

inline Eigen::VectorXd log_density(const GaussianMixture& mixture, const Eigen::MatrixXd& points) {
  return log_density(mixture, PointSet(points));
}
inline Eigen::MatrixXd responsibilities(const GaussianMixture& mixture, const Eigen::MatrixXd& points) {
  return responsibilities(mixture, PointSet(points));
}

}  // namespace modebank
