#pragma once

#include <Eigen/Core>
#include <vector>

#include "mixture/gaussian_mixture.hpp"
#include "mixture/point_blocks.hpp"

namespace modebank {

/// A mixture with its covariances factored once: log w_k N(x; mu_k, Sigma_k) = log_constant_k - |W_k (x - mu_k)|^2 / 2,
/// where W_k is the inverse of the lower Cholesky factor of Sigma_k.
struct ComponentFactors {
  Eigen::MatrixXd means;                   ///< F x K
  std::vector<Eigen::MatrixXd> whitening;  ///< K of F x F, lower triangular
  Eigen::VectorXd log_constants;           ///< K, log w_k + log det W_k - F/2 log(2 pi)
  bool diagonal = false;                   ///< whether every W_k is diagonal
};

/// Throws std::invalid_argument naming the first component whose covariance is not positive definite.
ComponentFactors factor(const GaussianMixture& mixture);

/// What the components say about one block of points.
struct BlockDensity {
  BlockColumns relative;    ///< block_size x K, w_k N_k(x) relative to the largest of the point, floored at exp(-600)
  BlockColumn sum;          ///< of `relative` over the components: 1 to K
  BlockColumn log_density;  ///< log sum_k w_k N_k(x); at least about -1e300, never NaN
};

/// Evaluates all components at `points` (block_size x F). `out` is reused between blocks.
void evaluate(const ComponentFactors& factors, const Eigen::Ref<const BlockColumns>& points, BlockDensity& out);

}  // namespace modebank
